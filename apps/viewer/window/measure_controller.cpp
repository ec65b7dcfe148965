// Collects points, and shows what they measure.
#include "apps/viewer/window/measure_controller.hpp"

#include <QCoreApplication>
#include <utility>

#include "apps/viewer/window/content.hpp"
#include "apps/viewer/window/messages.hpp"
#include "apps/viewer/window/views.hpp"

namespace palpate::viewer {

MeasureController::MeasureController(const Desk& desk) : Controller(desk) {
    connect(&views_, &Views::point_chosen, this, &MeasureController::add_point);
    connect(&views_, &Views::point_pointed_at, this, [this](const Vec3& at) { show(at); });
    connect(&content_, &Content::closed, this, &MeasureController::remove_all);
}

void MeasureController::begin(Measure kind) {
    if (!content_.volume()) return;
    made_ = Measurement{kind, {}};
    set(views_, &Shown::measuring, true);
    show();
    messages_.show_done(
        kind == Measure::length
            ? tr("Click two points on the surface or in a slice (Esc: give up)")
            : tr("Click a point on one side, the corner, and a point on the other side "
                 "(Esc: give up)"));
}

bool MeasureController::cancel() {
    if (!made_) return false;
    made_.reset();
    set(views_, &Shown::measuring, false);
    show();
    return true;
}

void MeasureController::add_point(const Vec3& at) {
    if (!made_) return;
    made_->points.push_back(at);
    if (made_->points.size() == points_of(made_->kind)) {
        done_.push_back(*std::exchange(made_, std::nullopt));
        set(views_, &Shown::measuring, false);
        const QString voxel = QCoreApplication::translate("Units", "voxel");
        messages_.show_done(QString::fromStdString(
            text_of(done_.back(), views_.shown().unit, voxel.toStdString())));
    }
    show();
}

void MeasureController::remove_last() {
    if (cancel() || done_.empty()) return;
    done_.pop_back();
    show();
}

void MeasureController::remove_all() {
    done_.clear();
    if (!cancel()) show();
}

void MeasureController::set_measurements(const std::vector<Measurement>& measurements) {
    done_ = measurements;
    show();
}

/// The one that is being made goes to where the pointer is.
void MeasureController::show(const std::optional<Vec3>& pointed_at) {
    std::vector<Measurement> all = done_;
    if (made_) {
        all.push_back(*made_);
        if (pointed_at) all.back().points.push_back(*pointed_at);
    }
    set(views_, &Shown::measurements, all);
}

}  // namespace palpate::viewer
