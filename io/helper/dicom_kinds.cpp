// Reads kinds and moments from headers. See the header.
#include "io/helper/dicom_kinds.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <sstream>

namespace palpate::io {
namespace {

constexpr std::size_t most_dimensions =
    64;  // of a frame; keys are compared in time that rises with them

/// [s] of a date (YYYYMMDD) and a time (HHMMSS.FFFFFF), or of both in one (DT); NaN if a part is
/// missing. The date counts from any day.
double moment_of(const std::string& date, std::string time) {
    std::erase(time, ':');  // of old files
    const auto digits = [](const std::string& text, std::size_t at, std::size_t count) {
        int value = -1;
        const std::string part = at < text.size() ? text.substr(at, count) : "";
        std::from_chars(part.data(), part.data() + part.size(), value);
        return value;
    };
    const int hours = digits(time, 0, 2), minutes = std::max(digits(time, 2, 2), 0);
    const int year = digits(date, 0, 4), month = std::max(digits(date, 4, 2), 1);
    if (hours < 0) return std::numeric_limits<double>::quiet_NaN();
    const int day = std::max(digits(date, 6, 2), 1);
    const double fraction =
        digits(time, 7, 6) < 0 ? 0 : std::strtod(("0." + time.substr(7, 6)).c_str(), nullptr);
    const double seconds = std::max(digits(time, 4, 2), 0) + fraction;
    // Months of 31 days keep the order, which is all that counts.
    return ((std::max(year, 0) * 12.0 + month) * 31 + day) * 86400 + hours * 3600 + minutes * 60 +
           seconds;
}

double moment_of(const std::string& both) {
    return both.size() < 10 ? std::numeric_limits<double>::quiet_NaN()
                            : moment_of(both.substr(0, 8), both.substr(8));
}

void add_kind(DicomSlice& s, const std::string& kind) {
    s.kind += (s.kind.empty() || kind.empty() ? "" : ", ") + kind;
}

void add_kind(DicomSlice& s, const char* name, double value, const char* unit) {
    if (std::isfinite(value)) add_kind(s, name + text_of(value) + unit);
}

}  // namespace

Segments segments_in(const DicomGroup& data) {
    Segments names;
    for (const DicomGroup& segment : data.items({0x0062, 0x0002})) {
        const auto number = segment.binary<std::uint16_t>({0x0062, 0x0004});
        if (!number.empty()) names[number[0]] = segment.text({0x0062, 0x0005});
    }
    return names;
}

/// Properties that distinguish images of one place in one series: magnitude or phase (the third
/// value of ImageType), the echo, the weighting by diffusion, and further values of ImageType.
void set_kind(DicomSlice& s, const DicomGroup& data) {
    std::istringstream values(data.text({0x0008, 0x0008}));
    std::string value;
    for (int i = 0; std::getline(values, value, '\\'); ++i) {
        value = trimmed(value);
        if (i == 2) s.kind = value;
        if (i > 2) s.contrast += (s.contrast.empty() ? "" : " ") + value;
    }
    if (const auto echo = data.numbers({0x0018, 0x0081}); !echo.empty()) s.echo = echo[0];
    add_kind(s, "b-value ", data.real({0x0018, 0x9087}), " s/mm2");
}

/// Properties that order the images of one place in one series.
void set_moment(DicomSlice& s, const DicomGroup& data) {
    const double none = std::numeric_limits<double>::quiet_NaN();
    const auto number_of = [&](DicomTag tag) {
        const double number = data.optional_number(tag);
        return std::isnan(number) ? 0 : number;
    };
    const double number = number_of({0x0020, 0x0013});
    s.instance = static_cast<int>(number);
    s.keys.assign(first_dimension, none);
    if (s.frames > 1) s.keys[file_number] = number;
    s.keys[temporal_position] = data.optional_number({0x0020, 0x0100});
    s.keys[trigger_time] = data.optional_number({0x0018, 0x1060});
    s.keys[reference_time] = data.optional_number({0x0054, 0x1300});
    s.keys[acquisition_time] = moment_of(data.text({0x0008, 0x002a}));
    if (std::isnan(s.keys[acquisition_time])) {
        s.keys[acquisition_time] =
            moment_of(data.text({0x0008, 0x0022}), data.text({0x0008, 0x0032}));
    }
    s.keys[content_time] = moment_of(data.text({0x0008, 0x0023}), data.text({0x0008, 0x0033}));
    s.keys[acquisition_number] = number_of({0x0020, 0x0012});
    s.keys[frame_number] = number;
}

/// Properties, other than their moment, that distinguish the frames of one place.
void set_kind(DicomSlice& s, const FunctionalGroups& groups, const Segments& segments) {
    s.kind.clear();
    // Frame types of MR, CT, PET, X-ray 3D, parametric maps and ultrasound.
    for (const DicomTag type : {DicomTag{0x0018, 0x9226},
                                {0x0018, 0x9329},
                                {0x0018, 0x9732},
                                {0x0018, 0x9504},
                                {0x0040, 0x9092},
                                {0x0018, 0x9806}}) {
        groups.with(type, [&](const DicomGroup& g) { add_kind(s, g.text({0x0008, 0x9007})); });
    }
    groups.with({0x0018, 0x9114}, [&](const DicomGroup& g) { s.echo = g.real({0x0018, 0x9082}); });
    groups.with({0x0018, 0x9117}, [&](const DicomGroup& g) {
        add_kind(s, "b-value ", g.real({0x0018, 0x9087}), " s/mm2");
    });
    groups.with({0x0062, 0x000a}, [&](const DicomGroup& g) {
        for (const std::uint16_t number : g.binary<std::uint16_t>({0x0062, 0x000b})) {
            const auto name = segments.find(number);
            add_kind(s, "segment " + std::to_string(number) +
                            (name == segments.end() ? "" : " " + name->second));
        }
    });
}

/// Properties that order the frames of one place.
void set_moment(DicomSlice& s, const FunctionalGroups& groups) {
    groups.with({0x0020, 0x9111}, [&](const DicomGroup& g) {
        s.stack = g.text({0x0020, 0x9056});
        const auto place = g.binary<std::uint32_t>({0x0020, 0x9057});
        s.is_numbered = !place.empty();
        if (s.is_numbered) s.order = static_cast<int>(place[0]);
        const auto moment = g.binary<std::uint32_t>({0x0020, 0x9128});
        if (!moment.empty()) s.keys[temporal_position] = moment[0];
        s.keys[reference_time] = moment_of(g.text({0x0018, 0x9151}));
        s.keys[acquisition_time] = moment_of(g.text({0x0018, 0x9074}));
        const auto dimensions = g.binary<std::uint32_t>({0x0020, 0x9157});
        if (dimensions.size() > most_dimensions) {
            throw Failure("has too many dimensions (DimensionIndexValues); export it again");
        }
        s.keys.insert(s.keys.end(), dimensions.begin(), dimensions.end());
    });
    groups.with({0x0018, 0x9118}, [&](const DicomGroup& g) {
        s.keys[trigger_time] = g.real({0x0020, 0x9153});
        s.keys[cardiac_phase] = g.real({0x0020, 0x9241});
    });
    groups.with({0x0020, 0x9310}, [&](const DicomGroup& g) {
        s.keys[reference_time] = g.real({0x0020, 0x930d});
    });
}

}  // namespace palpate::io
