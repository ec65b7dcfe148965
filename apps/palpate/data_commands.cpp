// Reads commands for edits and sequences.
#include "apps/palpate/data_commands.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "apps/palpate/commands.hpp"
#include "io/system/number.hpp"
#include "palpate/io/level.hpp"
#include "palpate/names.hpp"

namespace palpate::app {
namespace {

double number_in(const CommandWords& words, const std::string& text) {
    if (text == "inf") return std::numeric_limits<double>::infinity();
    const auto value = io::number_from<double>(text);
    if (!value) words.refuse();
    return *value;
}

Vec3 point_in(const CommandWords& words, const std::string& text) {
    Vec3 p;
    std::size_t begin = 0;
    for (int a = 0; a < 3; ++a) {
        const std::size_t end = a < 2 ? text.find(',', begin) : text.size();
        if (end == std::string::npos) words.refuse();
        p[a] = number_in(words, text.substr(begin, end - begin));
        begin = end + 1;
    }
    return p;
}

/// The word after the name: "A" or "A:B".
std::array<Vec3, 2> two_points(const CommandWords& words) {
    const std::string& text = words[1];
    const std::size_t colon = text.find(':');
    const Vec3 first = point_in(words, text.substr(0, colon));
    return {first, colon == std::string::npos ? first : point_in(words, text.substr(colon + 1))};
}

/// A request that has nothing to say.
template <class Change>
DataRequest silent(Change change) {
    return [change](run::Data& data, const Field&, double, const io::Progress&) {
        change(data);
        return std::string();
    };
}

DataRequest stroke(const CommandWords& words, const Volume& volume) {
    words.expect(3, 4);
    run::HandBrush hand;
    hand.kind = named<BrushKind>(words.name());
    hand.radius = words.number(2);
    if (words.count() > 3) hand.value = io::level_from_text(words[3], volume);
    run::check(hand);
    const auto ends = two_points(words);
    if (!ends[0].allFinite() || !ends[1].allFinite()) words.refuse();
    return [hand, ends](run::Data& data, const Field& field, double isovalue,
                        const io::Progress& progress) {
        if (!std::isfinite(isovalue))
            throw std::invalid_argument(
                "there is no surface to touch now, so the brush has nothing to work on");
        Brush brush = brush_for(hand.kind, field, isovalue, hand.radius);
        if (hand.value) brush.value = *hand.value;
        data.editor().apply(edit::Stroke{brush, ends[0], ends[1]}, progress);
        return std::string();
    };
}

DataRequest fill(const CommandWords& words, const Volume& volume) {
    words.expect(3);
    const auto [low, high] = two_points(words);
    const double most = std::max(low.cwiseAbs().maxCoeff(), high.cwiseAbs().maxCoeff());
    if (!(most <= 1 << 20) || low != low.array().floor().matrix() ||
        high != high.array().floor().matrix()) {
        words.refuse();
    }
    const SampleBox box{low.cwiseMin(high).cast<int>(), low.cwiseMax(high).cast<int>()};
    if ((box.high.array() < 0).any() || (box.low.array() >= volume.geometry().size.array()).any()) {
        throw std::invalid_argument("this box lies outside the volume");
    }
    const edit::Fill fill{box, io::level_from_text(words[2], volume)};
    check(fill, volume.type());
    return [fill](run::Data& data, const Field&, double, const io::Progress& progress) {
        data.editor().apply(fill, progress);
        return std::string();
    };
}

DataRequest save(const CommandWords& words, const run::Data& now) {
    const std::string path = words.expect(2)[1];
    now.check_save_name(path);
    return [path](run::Data& data, const Field&, double, const io::Progress&) {
        // A save that has begun is completed after the session, unless Ctrl-C is pressed again.
        return data.save(path, [before = interruptions()](double) {
            if (interruptions() > before + 1) throw io::OutputError("saving was interrupted");
        });
    };
}

DataRequest seek(const CommandWords& words) {
    const double time = words.expect(2).number(1);
    if (!std::isfinite(time)) words.refuse();
    return silent([time](run::Data& data) { data.player().seek(time); });
}

/// The value after the name, at most `most` in size; without one 1.
double one_or(const CommandWords& words, double most) {
    const double value = words.expect(1, 2).count() > 1 ? words.number(1) : 1;
    if (!(std::abs(value) <= most)) words.refuse();
    return value;
}

}  // namespace

std::vector<std::string> CommandWords::in(std::string_view line) {
    constexpr std::string_view blanks = " \t\r\n\v\f";
    std::vector<std::string> all;
    for (;;) {
        line.remove_prefix(std::min(line.find_first_not_of(blanks), line.size()));
        if (line.empty()) return all;
        const bool is_quoted = line.front() == '"';
        if (is_quoted) line.remove_prefix(1);
        const std::size_t end = is_quoted ? line.find('"') : line.find_first_of(blanks);
        if (is_quoted && end == line.npos) {
            throw std::invalid_argument("there is a \" without another one after it");
        }
        all.emplace_back(line.substr(0, end));
        line.remove_prefix(std::min(all.back().size() + (is_quoted ? 1 : 0), line.size()));
    }
}

void CommandWords::refuse() const {
    throw std::invalid_argument("expected: " + usage_);
}

const CommandWords& CommandWords::expect(std::size_t least, std::size_t most) const {
    if (count() < least || count() > most) refuse();
    return *this;
}

double CommandWords::number(std::size_t at) const {
    if (at >= count()) refuse();
    return number_in(*this, words_[at]);
}

bool CommandWords::on_or_off() const {
    if (count() != 2 || (words_[1] != "on" && words_[1] != "off")) refuse();
    return words_[1] == "on";
}

std::optional<run::HandBrush> brush_from(const CommandWords& words, const Volume& volume) {
    if (words.count() == 2 && words[1] == "off") return std::nullopt;
    words.expect(3, 5);
    run::HandBrush brush;
    brush.kind = named<BrushKind>(words[1]);
    const std::string& size = words[2];
    if (size == "tool" || size.starts_with("tool:")) {
        brush.as_tool = true;
        brush.radius = size == "tool" ? run::tool_brush(volume.geometry()).radius
                                      : number_in(words, size.substr(5));
    } else {
        brush.radius = words.number(2);
    }
    if (words.count() > 3) brush.rate = words.number(3);
    if (words.count() > 4) brush.value = io::level_from_text(words[4], volume);
    run::check(brush);
    return brush;
}

DataRequest set_brush(const std::optional<run::HandBrush>& brush) {
    return [brush](run::Data& data, const Field&, double, const io::Progress&) {
        data.editor().set_brush(brush);
        if (!brush) return std::string("brush: off");
        return fmt::format("brush: {}, {:g} mm{}", enum_name(brush->kind), brush->radius,
                           brush->as_tool ? " around the tool" : "");
    };
}

DataRequest undo() {
    return [](run::Data& data, const Field&, double, const io::Progress& progress) {
        return data.editor().undo(progress) ? "" : "there is nothing to undo";
    };
}

DataRequest redo() {
    return [](run::Data& data, const Field&, double, const io::Progress& progress) {
        return data.editor().redo(progress) ? "" : "there is nothing to redo";
    };
}

DataRequest play(double speed) {
    return silent([speed](run::Data& data) { data.player().play(speed); });
}

DataRequest step(int frames) {
    return silent([frames](run::Data& data) { data.player().step(frames); });
}

DataRequest data_request(const CommandWords& words, const run::Data& now, const Volume& volume) {
    const std::string& name = words.name();
    const bool alone = words.count() == 1;
    constexpr std::array edits{"carve", "add", "smooth", "paint", "fill", "undo", "redo"};
    constexpr std::array plays{"play", "pause", "step", "seek", "loop"};
    if (std::ranges::find(edits, name) != edits.end()) (void)now.editor();
    if (std::ranges::find(plays, name) != plays.end()) (void)now.player();
    if (name == "carve" || name == "add" || name == "smooth" || name == "paint") {
        return stroke(words.as(name + " X,Y,Z[:X,Y,Z] RADIUS [VALUE]"), volume);
    }
    if (name == "fill") return fill(words.as("fill I,J,K[:I,J,K] VALUE"), volume);
    if (name == "undo" && alone) return undo();
    if (name == "redo" && alone) return redo();
    if (name == "save") return save(words.as("save FILE"), now);
    if (name == "play") return play(one_or(words.as("play [SPEED], at most 1000"), 1000));
    if (name == "pause" && alone) return play(0);
    if (name == "step") return step(static_cast<int>(one_or(words.as("step [FRAMES]"), 1e6)));
    if (name == "seek") return seek(words.as("seek SECONDS"));
    if (name == "loop") {
        const bool on = words.as("loop on|off").on_or_off();
        return silent([on](run::Data& data) { data.player().set_loop(on); });
    }
    return {};
}

}  // namespace palpate::app
