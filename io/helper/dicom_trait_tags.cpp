// The properties by which DICOM images of one place in one series may differ, other than by their
// moment: where a file and the functional groups of a frame have them.
#include <algorithm>
#include <cmath>

#include "io/helper/dicom_attributes.hpp"

namespace palpate::io {
namespace {

enum class Written { number, word, vector };

struct TraitTag {
    const char* name;
    DicomTag tag;       ///< in a file
    DicomTag group;     ///< of functional groups; none: 0, 0
    DicomTag in_group;  ///< the tag there
    Written written = Written::number;
    const char* unit = "";
    bool is_series = true;
};

constexpr DicomTag none{};
constexpr TraitTag tags[] = {
    {"inversion time",
     {0x0018, 0x0082},
     {0x0018, 0x9115},
     {0x0018, 0x9079},
     Written::number,
     " ms"},
    {"flip angle", {0x0018, 0x1314}, {0x0018, 0x9112}, {0x0018, 0x1314}, Written::number, " deg"},
    {"repetition time",
     {0x0018, 0x0080},
     {0x0018, 0x9112},
     {0x0018, 0x0080},
     Written::number,
     " ms"},
    {"echo number", {0x0018, 0x0086}, none, none},
    {"saturation", {0x0018, 0x9020}, {0x0018, 0x9115}, {0x0018, 0x9020}, Written::word},
    {"contrast", {0x0008, 0x9209}, {0x0018, 0x9226}, {0x0008, 0x9209}, Written::word},
    {"coil", {0x0018, 0x1250}, {0x0018, 0x9042}, {0x0018, 0x1250}, Written::word},
    {"scan options", {0x0018, 0x0022}, none, none, Written::word},
    {"velocity along", {0x0018, 0x9090}, {0x0018, 0x9197}, {0x0018, 0x9090}, Written::vector},
    {"tube voltage", {0x0018, 0x0060}, {0x0018, 0x9325}, {0x0018, 0x0060}, Written::number, " kV"},
    {"kernel", {0x0018, 0x1210}, {0x0018, 0x9314}, {0x0018, 0x1210}, Written::word},
    {"filter", {0x0018, 0x1160}, none, none, Written::word},
    {"reconstruction", {0x0054, 0x1103}, none, none, Written::word},
    {"corrections", {0x0028, 0x0051}, none, none, Written::word},
    {"units", {0x0028, 0x1054}, {0x0028, 0x9145}, {0x0028, 0x1054}, Written::word},
    {"protocol", {0x0018, 0x1030}, none, none, Written::word},
    // Diffusion has many directions, which are steps of one series.
    {"gradient along", {0x0018, 0x9089}, none, none, Written::vector, "", false},
};

/// In place of what the file says of all its frames.
void set_trait(DicomSlice& s, const TraitTag& one, const DicomGroup& data, DicomTag tag) {
    if (!data.has(tag)) return;
    DicomTrait trait;
    trait.name = one.name;
    trait.unit = one.unit;
    trait.is_series = one.is_series;
    if (one.written == Written::number) {
        trait.number = data.optional_number(tag);
    } else if (one.written == Written::word) {
        trait.word = data.text(tag);
    } else {
        for (const double part : data.binary<double>(tag)) {
            trait.word += (trait.word.empty() ? "" : " ") + text_of(part);
        }
    }
    if (std::isnan(trait.number) && trait.word.empty()) return;
    std::erase_if(s.traits, [&](const DicomTrait& t) { return t.name == trait.name; });
    s.traits.push_back(std::move(trait));
}

}  // namespace

void set_traits(DicomSlice& s, const DicomGroup& data) {
    for (const TraitTag& one : tags) set_trait(s, one, data, one.tag);
}

void set_traits(DicomSlice& s, const FunctionalGroups& groups) {
    for (const TraitTag& one : tags) {
        if (one.group == none) continue;
        groups.with(one.group, [&](const DicomGroup& g) { set_trait(s, one, g, one.in_group); });
    }
    groups.with({0x0018, 0x9117}, [&](const DicomGroup& diffusion) {
        const auto directions = diffusion.items({0x0018, 0x9076});
        if (!directions.empty()) set_trait(s, std::end(tags)[-1], directions[0], {0x0018, 0x9089});
    });
}

}  // namespace palpate::io
