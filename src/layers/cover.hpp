// Covers a field with labels. Layers reach the labels of a field through this header.
#pragma once

#include "palpate/field.hpp"

namespace palpate {

struct LabelCover {
    /// From now on samples with a label above 0 are `solid` [data units] where it is one of these
    /// bits, else `open`; with bit 0 samples without a label, and all outside the grid, are solid,
    /// too. `labels`: one uint8 volume of labels up to 31 that is not edited, on any grid; a sample
    /// of this field has the label that is nearest to it, 0 outside of them. Does not allocate. The
    /// samples may be those of the labels: then `open` has to be 0.
    static void put(Field& field, const std::shared_ptr<const Field>& labels,
                    std::uint32_t solid_labels, double open, double solid) noexcept {
        field.cover(labels, solid_labels, open, solid);
    }
    /// Null without put().
    static const Field* of(const Field& field) noexcept { return field.cover_.labels.get(); }
    /// The labels of the sample `at` and its neighbours, placed like Neighbours.
    static std::array<std::uint8_t, 27> around(const Field& field, const Index3& at) noexcept {
        return field.labels_of<3>(at - Index3::Ones());
    }
    /// Whether the sample `at` or one of its neighbours has such a label.
    static bool is_near(const Field& field, const Index3& at) noexcept {
        return field.is_labelled<3>(at - Index3::Ones());
    }
};

}  // namespace palpate
