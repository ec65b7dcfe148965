// Orders slices by the numbers in their names. See the header.
#include "io/helper/numbered_names.hpp"

#include <algorithm>
#include <cctype>
#include <limits>
#include <map>
#include <optional>

#include "io/system/number.hpp"

namespace palpate::io {
namespace {

namespace fs = std::filesystem;

bool is_digit(char c) {
    return std::isdigit(static_cast<unsigned char>(c)) != 0;
}

/// A number in a name, as text ("007", "2.5", "-3"), or the text between two numbers.
struct NamePart {
    std::string text;
    bool is_number = false;

    bool is_negative() const { return is_number && text.front() == '-'; }

    bool operator==(const NamePart&) const = default;
};

/// -1 before 2 before 10, 1.25 before 1.5, numbers before text.
bool is_before(const NamePart& a, const NamePart& b) {
    if (a.is_number != b.is_number) return a.is_number;
    if (!a.is_number) return a.text < b.text;
    if (a.is_negative() != b.is_negative()) return a.is_negative();
    if (a.is_negative()) return is_before({b.text.substr(1), true}, {a.text.substr(1), true});
    const auto whole = [](const std::string& text) {
        const auto begin = std::min(text.find_first_not_of('0'), text.size());
        const auto end = std::min(text.find('.'), text.size());
        return begin < end ? text.substr(begin, end - begin) : std::string();
    };
    const std::string x = whole(a.text), y = whole(b.text);
    if (x.size() != y.size()) return x.size() < y.size();
    if (x != y) return x < y;
    const auto fraction = [](const std::string& text) {
        return text.substr(std::min(text.find('.'), text.size()));
    };
    if (fraction(a.text) != fraction(b.text)) return fraction(a.text) < fraction(b.text);
    return a.text < b.text;  // 01 and 1 are two names
}

using Name = std::vector<NamePart>;

/// A point between two numbers belongs to them, unless there are more points: "1.5", not "1.5.2".
Name parts_of(const fs::path& file) {
    const std::string stem = file.stem().string();
    Name parts;
    for (std::size_t at = 0; at < stem.size();) {
        const bool number = is_digit(stem[at]);
        std::size_t end = at;
        while (end < stem.size() && is_digit(stem[end]) == number) ++end;
        const std::string text = stem.substr(at, end - at);
        const bool fraction = number && parts.size() >= 2 && parts.back().text == "." &&
                              parts[parts.size() - 2].text.find('.') == std::string::npos &&
                              (end == stem.size() || stem[end] != '.');
        if (fraction && (parts.size() < 3 || parts[parts.size() - 3].text.back() != '.')) {
            parts.pop_back();
            parts.back().text += "." + text;
        } else {
            parts.push_back({text, number});
        }
        at = end;
    }
    return parts;
}

struct NamedFile {
    fs::path path;
    Name name;
};

bool comes_before(const NamedFile& a, const NamedFile& b) {
    if (std::ranges::lexicographical_compare(a.name, b.name, is_before)) return true;
    return !std::ranges::lexicographical_compare(b.name, a.name, is_before) && a.path < b.path;
}

/// A hyphen before a number is a sign if it is missing in other files: z-1, z0, z1. In z-1, z-2 it
/// only separates.
void find_signs(std::vector<NamedFile>& files) {
    const auto text_at = [](const NamedFile& file, std::size_t p) {
        const bool leads = p + 1 < file.name.size() && !file.name[p].is_number;
        return leads ? file.name[p].text : std::string();
    };
    for (std::size_t p = 0; p < files.front().name.size(); ++p) {
        const auto shortest = std::ranges::min_element(
            files, {}, [&](const NamedFile& file) { return text_at(file, p).size(); });
        const std::string plain = text_at(*shortest, p);
        const auto is_like = [&](const NamedFile& file) {
            const std::string text = text_at(file, p);
            return text == plain || text == plain + "-";
        };
        if (plain.empty() || !std::ranges::all_of(files, is_like)) continue;
        for (NamedFile& file : files) {
            if (file.name[p].text == plain) continue;
            file.name[p].text = plain;
            file.name[p + 1].text.insert(0, "-");
        }
    }
}

/// The quantity that a number counts.
enum class Counts { slices, channels, times, unknown };

/// By the letters before it.
Counts counted_by(const std::string& before) {
    static const std::map<std::string, Counts> marks = {
        {"z", Counts::slices},        {"slice", Counts::slices}, {"section", Counts::slices},
        {"plane", Counts::slices},    {"c", Counts::channels},   {"ch", Counts::channels},
        {"chan", Counts::channels},   {"w", Counts::channels},   {"channel", Counts::channels},
        {"t", Counts::times},         {"time", Counts::times},   {"tp", Counts::times},
        {"timepoint", Counts::times},
    };
    const auto is_letter = [](char c) { return std::isalpha(static_cast<unsigned char>(c)) != 0; };
    std::size_t end = before.size();
    while (end > 0 && !is_letter(before[end - 1])) --end;
    std::size_t begin = end;
    while (begin > 0 && is_letter(before[begin - 1])) --begin;
    const auto found = marks.find(lower(before.substr(begin, end - begin)));
    return found == marks.end() ? Counts::unknown : found->second;
}

/// A part of the names that differs from file to file.
struct Field {
    std::size_t part = 0;
    Counts counts = Counts::unknown;
    std::vector<NamePart> values;  ///< in their order, each once

    bool is_of_others() const { return counts == Counts::channels || counts == Counts::times; }
};

/// Orders files by the value that each has in a field.
auto by_value_of(const Field& field) {
    return [part = field.part](const NamedFile& a, const NamedFile& b) {
        return is_before(a.name[part], b.name[part]);
    };
}

/// Empty if the names are not alike: if some have more parts than others, or text in place of a
/// number.
std::vector<Field> fields_of(const std::vector<NamedFile>& files) {
    const Name& first = files.front().name;
    std::vector<Field> fields;
    for (std::size_t p = 0; p < first.size(); ++p) {
        Field field{p, Counts::unknown, {}};
        for (const NamedFile& file : files) {
            if (file.name.size() != first.size() || file.name[p].is_number != first[p].is_number) {
                return {};
            }
            field.values.push_back(file.name[p]);
        }
        std::ranges::sort(field.values, is_before);
        // (clang 14 cannot read libstdc++'s std::ranges::unique)
        field.values.erase(std::unique(field.values.begin(), field.values.end()),
                           field.values.end());
        if (field.values.size() < 2) continue;
        if (first[p].is_number && p > 0) field.counts = counted_by(first[p - 1].text);
        fields.push_back(std::move(field));
    }
    return fields;
}

/// "'_z000' to '_z009', '_ch00' to '_ch01'"
std::string text_of_fields(const std::vector<Field>& fields, const Name& name) {
    std::string text;
    for (const Field& field : fields) {
        const std::string before = field.part > 0 ? name[field.part - 1].text : "";
        text += (text.empty() ? "'" : ", '") + before + field.values.front().text + "' to '" +
                before + field.values.back().text + "'";
    }
    return text;
}

[[noreturn]] void fail_unclear(const std::vector<Field>& fields, const Name& name) {
    throw Failure("the names of its slices differ in more than one place (" +
                  text_of_fields(fields, name).substr(0, 200) +
                  "), and which of them counts slices is not certain; put the slices of one volume "
                  "into a folder of their own, or write z, c and t before the numbers");
}

/// A field for slices, channels and times each, where there is one; the only one that is not known
/// is for slices.
std::map<Counts, Field> roles_of(const std::vector<Field>& fields, const Name& name) {
    std::map<Counts, Field> roles;
    for (const Field& field : fields) {
        if (!roles.emplace(field.counts, field).second) fail_unclear(fields, name);
    }
    if (const auto open = roles.find(Counts::unknown); open != roles.end()) {
        if (!name[open->second.part].is_number) fail_unclear(fields, name);
        if (!roles.emplace(Counts::slices, open->second).second) fail_unclear(fields, name);
        roles.erase(Counts::unknown);
    }
    if (!roles.contains(Counts::slices)) fail_unclear(fields, name);
    return roles;
}

/// How many numbers are missing between the first and the last, in least steps. A constant step
/// (every second number) is a way of naming, not a gap.
long missing_in(const Field& field) {
    std::vector<long> numbers;
    for (const NamePart& value : field.values) {
        const auto number = value.is_number ? number_from<long>(value.text) : std::nullopt;
        if (!number) return 0;
        numbers.push_back(*number);
    }
    long step = std::numeric_limits<long>::max();
    for (std::size_t i = 1; i < numbers.size(); ++i) {
        step = std::min(step, numbers[i] - numbers[i - 1]);
    }
    if (step < 1) return 0;  // two spellings of a number
    const long span = numbers.back() - numbers.front();
    return span / step - (static_cast<long>(numbers.size()) - 1);
}

/// Put together without them, lengths across the stack would be too short.
void check_missing(long missing) {
    if (missing == 0) return;
    throw Failure("of the numbers in its slices' names, " + std::to_string(missing) +
                  (missing == 1 ? " is" : " are") +
                  " missing; copy the missing slices, or number the others without a gap");
}

/// The numbers that may count slices among those that differ in every file: those that are marked
/// as slices, or else those without a mark, or else those that are marked as something else.
std::vector<Field> counting_slices(const std::vector<Field>& fields, std::size_t files,
                                   const Name& name) {
    std::map<int, std::vector<Field>> found;  // by rank
    for (const Field& field : fields) {
        if (field.values.size() != files || !name[field.part].is_number) continue;
        const int rank = field.counts == Counts::slices ? 0 : field.is_of_others() ? 2 : 1;
        found[rank].push_back(field);
    }
    return found.empty() ? std::vector<Field>{} : found.begin()->second;
}

/// "7" for "007".
std::string without_zeros(const std::string& number) {
    const std::size_t point = std::min(number.find('.'), number.size());
    const bool is_negative = number.front() == '-';
    const std::size_t digits = number.find_first_not_of('0', is_negative ? 1 : 0);
    if (digits >= point) return "0" + number.substr(point);
    return (is_negative ? "-" : "") + number.substr(digits);
}

/// Throws Failure if numbers tell slices apart, but two files have the same: which one is the
/// slice?
void check_twice(const std::vector<NamedFile>& files, bool is_counted) {
    std::map<std::vector<std::string>, std::string> names;  // by their numbers
    std::string twice;
    for (const NamedFile& file : files) {
        std::vector<std::string> numbers;
        for (const NamePart& part : file.name) {
            if (part.is_number) numbers.push_back(without_zeros(part.text));
        }
        if (numbers.empty()) continue;
        const std::string name = file.path.filename().string();
        const auto [found, is_new] = names.emplace(std::move(numbers), name);
        if (!is_new && twice.empty()) twice = "'" + found->second + "' and '" + name + "'";
    }
    if (twice.empty() || (names.size() == 1 && !is_counted)) return;
    throw Failure("two of its slices have the same numbers in their names (" + twice +
                  "); put the slices of one volume into a folder of their own");
}

/// All files, in the order of the numbers that count slices. Without any, in that of their names.
NumberedSlices one_stack(std::vector<NamedFile> files, const std::vector<Field>& fields) {
    const std::vector<Field> counting = counting_slices(fields, files.size(), files.front().name);
    check_twice(files, !counting.empty());
    for (const Field& field : counting) {
        if (&field == &counting.front()) std::ranges::sort(files, by_value_of(field));
        if (!std::ranges::is_sorted(files, by_value_of(field))) {
            fail_unclear(counting, files.front().name);
        }
    }
    NumberedSlices slices;
    slices.times.emplace_back();
    for (const NamedFile& file : files) slices.times[0].push_back(file.path);
    if (fields.empty() && files.size() > 1) {
        slices.notes.emplace_back(
            "the names of its slices are not alike: they were put together in the order of their "
            "names");
    }
    std::optional<long> missing;  // of numbers that go together, one may be a time of day
    for (const Field& field : counting) {
        missing = std::min(missing.value_or(missing_in(field)), missing_in(field));
    }
    check_missing(missing.value_or(0));
    if (fields.size() == 1 && fields[0].is_of_others()) {
        slices.notes.push_back("the numbers in its names (" +
                               text_of_fields(fields, files.front().name).substr(0, 100) +
                               ") seem to count " +
                               (fields[0].counts == Counts::times ? "times" : "channels") +
                               ": they were taken as slices");
    }
    return slices;
}

/// Files of every slice for every channel and time: those of the first channel.
NumberedSlices first_channel(std::vector<NamedFile> files, const std::vector<Field>& fields) {
    const Name first = files.front().name;
    const std::map<Counts, Field> roles = roles_of(fields, first);
    std::size_t all = 1;
    for (const auto& [counts, field] : roles) all *= field.values.size();
    if (all != files.size()) {
        throw Failure("it has " + std::to_string(files.size()) + " slices where their names (" +
                      text_of_fields(fields, first).substr(0, 200) + ") count " +
                      std::to_string(all) +
                      "; copy the missing ones, or put those of one volume into a folder of their "
                      "own");
    }
    NumberedSlices slices;
    const auto channels = roles.find(Counts::channels), times = roles.find(Counts::times);
    if (channels != roles.end()) {
        const Field& field = channels->second;
        std::erase_if(files, [&](const NamedFile& file) {
            return file.name[field.part] != field.values.front();
        });
        slices.notes.push_back("by the names of its slices it has " +
                               std::to_string(field.values.size()) + " channels: '" +
                               first[field.part - 1].text + field.values.front().text +
                               "' was taken; put the slices of another one into a folder of "
                               "their own");
    }
    const Field& z = roles.at(Counts::slices);
    std::ranges::stable_sort(files, by_value_of(z));
    slices.times.resize(times == roles.end() ? 1 : times->second.values.size());
    for (const NamedFile& file : files) {
        std::size_t time = 0;
        if (times != roles.end()) {
            const auto& values = times->second.values;
            const auto found = std::ranges::find(values, file.name[times->second.part]);
            time = static_cast<std::size_t>(found - values.begin());
        }
        slices.times[time].push_back(file.path);
    }
    check_missing(missing_in(z));
    return slices;
}

}  // namespace

NumberedSlices numbered_slices(std::vector<fs::path> paths) {
    std::vector<NamedFile> files;
    for (fs::path& path : paths) {
        Name name = parts_of(path);
        files.push_back({std::move(path), std::move(name)});
    }
    find_signs(files);
    std::ranges::sort(files, comes_before);
    const std::vector<Field> fields = fields_of(files);
    std::vector<Field> shared;  // with values that several files have
    bool told = fields.empty();
    for (const Field& field : fields) {
        const bool is_unique = field.values.size() == files.size();
        if (!is_unique) shared.push_back(field);
        told |= is_unique && field.counts == Counts::slices;
    }
    const bool marked = std::ranges::any_of(
        shared, [](const Field& field) { return field.counts != Counts::unknown; });
    const bool alone = shared.size() < fields.size() && !marked;
    return told || alone ? one_stack(std::move(files), fields)
                         : first_channel(std::move(files), shared);
}

}  // namespace palpate::io
