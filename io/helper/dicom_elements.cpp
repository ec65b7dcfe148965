// Reads elements of a DICOM file. See the header.
#include "io/helper/dicom_elements.hpp"

#include <algorithm>
#include <cctype>
#include <set>
#include <utility>

namespace palpate::io {
namespace {

bool is_long_type(const std::string& vr) {
    static const std::set<std::string> all = {"OB", "OW", "OF", "OD", "OL", "OV", "SQ",
                                              "UC", "UR", "UT", "UN", "SV", "UV"};
    return all.contains(vr);
}

bool is_short_type(const std::string& vr) {
    static const std::set<std::string> all = {"AE", "AS", "AT", "CS", "DA", "DS", "DT",
                                              "FD", "FL", "IS", "LO", "LT", "PN", "SH",
                                              "SL", "SS", "ST", "TM", "UI", "UL", "US"};
    return all.contains(vr);
}

}  // namespace

void DicomElements::fail(const std::string& what) const {
    throw Failure(quoted(file_) + " " + what + "; copy or export it again");
}

bool DicomElements::is_type(const std::string& letters) {
    return is_long_type(letters) || is_short_type(letters);
}

std::uint32_t DicomElements::tag_at(std::uint64_t at) {
    return std::uint32_t{number<std::uint16_t>(at)} << 16 | number<std::uint16_t>(at + 2);
}

DicomElement DicomElements::element(std::uint64_t& at, bool is_explicit) {
    DicomElement e;
    e.tag = tag_at(at);
    at += 4;
    if (!is_explicit || e.tag >> 16 == 0xfffe) {
        e.length = number<std::uint32_t>(at);
        at += 4;
        return e;
    }
    e.vr = {number<char>(at), number<char>(at + 1)};
    const auto is_no_letter = [](unsigned char c) { return std::isalpha(c) == 0; };
    if (e.tag != 0 && std::ranges::any_of(e.vr, is_no_letter)) {
        if (takes_empty_type(at, e)) return e;
        e.vr.clear();  // some writers leave it out here and there, or everywhere
        lacks_types_ = true;
        e.length = number<std::uint32_t>(at);
        at += 4;
        return e;
    }
    if (!is_long_type(e.vr) && !is_short_type(e.vr))
        fail("is damaged (an element of no known type)");
    take_length(at, e, is_long_type(e.vr));
    return e;
}

void DicomElements::take_length(std::uint64_t& at, DicomElement& e, bool is_long) {
    e.length = is_long ? number<std::uint32_t>(at + 4) : number<std::uint16_t>(at + 2);
    at += is_long ? 8 : 4;
}

/// Some writers put "??" or zeros in the place of a type. Its length is short or long: the one
/// behind which the data set goes on. Libraries get to see a type of such a length.
bool DicomElements::takes_empty_type(std::uint64_t& at, DicomElement& e) {
    const bool is_marked = e.vr == "??";
    if (!is_marked && e.vr != std::string(2, '\0')) return false;
    for (const bool is_long : {false, true}) {
        if (!goes_on(at, e, is_long)) continue;
        e.vr = is_long ? "UN" : "LO";
        given_types_[at] = e.vr;
        take_length(at, e, is_long);
        return true;
    }
    if (is_marked) fail("has an element of the type '?\?', whose length is not sure");
    return false;
}

/// Whether a known element, the end of an item or that of the file comes after elements like
/// `e`, whose type is at `at`.
bool DicomElements::goes_on(std::uint64_t at, DicomElement e, bool is_long) {
    constexpr int most = 100;
    const std::string type = e.vr;
    for (int i = 0; i < most; ++i) {
        if (!bytes_.reaches(at + 8) || (is_long && number<std::uint16_t>(at + 2) != 0)) {
            return false;
        }
        take_length(at, e, is_long);
        at += e.length;
        if (!bytes_.reaches(at + 8)) return bytes_.reaches(at) && !bytes_.reaches(at + 1);
        const std::uint32_t before = std::exchange(e.tag, tag_at(at));
        if (e.tag >> 16 == 0xfffe) return true;
        e.vr = {number<char>(at + 4), number<char>(at + 5)};
        const bool is_known = is_long_type(e.vr) || is_short_type(e.vr);
        if (e.tag <= before || !(is_known || e.vr == type)) return false;
        if (is_known) return true;
        at += 4;
    }
    return true;
}

}  // namespace palpate::io
