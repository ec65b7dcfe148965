// Lays out the scene and the slices side by side, and keeps them in step.
#include "apps/viewer/window/views.hpp"

#include <QBoxLayout>
#include <QSplitter>

#include "apps/viewer/panel/layout.hpp"
#include "apps/viewer/scene/scene.hpp"
#include "apps/viewer/slices/slice_pane.hpp"

namespace palpate::viewer {

Views::Views(QWidget* parent)
    : QWidget(parent),
      scene_(new Scene),
      slices_{new SlicePane(0), new SlicePane(1), new SlicePane(2)},
      across_(new QSplitter(Qt::Horizontal)),
      down_(new QSplitter(Qt::Vertical)) {
    row_in(this, {across_});
    scene_->setObjectName("scene");
    scene_->setMinimumSize(200, 200);
    across_->addWidget(scene_);
    across_->addWidget(down_);
    across_->setStretchFactor(0, 3);
    across_->setStretchFactor(1, 1);
    across_->setSizes({900, 300});
    // Axial above, as is usual.
    for (const std::size_t axis : {2U, 1U, 0U}) {
        SlicePane* pane = slices_[axis];
        pane->setObjectName(QString("slice%1").arg(axis));
        down_->addWidget(pane);
        connect(pane, &SlicePane::crosshair_chosen, this, &Views::choose_crosshair);
        connect(pane, &SlicePane::probe_aimed, this, &Views::probe_aimed);
        connect(pane, &SlicePane::window_changed, this, &Views::set_window);
    }
    connect(scene_, &Scene::probe_dragged, this, &Views::probe_dragged);
}

void Views::set_field(const Field& field, double isovalue) {
    scene_->set_field(field, isovalue);
    for (SlicePane* pane : slices_) pane->set_field(field, isovalue);
    set_crosshair(physical_centre(field.geometry()));
}

void Views::update_field(const Field& field) {
    scene_->update_field(field);
    for (SlicePane* pane : slices_) pane->update_field(field);
}

void Views::clear() {
    scene_->clear();
    for (SlicePane* pane : slices_) pane->clear();
}

void Views::set_isovalue(double isovalue) {
    scene_->set_isovalue(isovalue);
    for (SlicePane* pane : slices_) pane->set_isovalue(isovalue);
}

void Views::set_look(const Look& look) {
    scene_->set_look(look);
}

void Views::show_snapshot(const std::optional<Snapshot>& snapshot) {
    scene_->show_snapshot(snapshot);
    const bool placed = snapshot && snapshot->session.device.status == DeviceStatus::ready &&
                        snapshot->session.tick.proxy.scp.allFinite();
    if (placed && follow_) set_crosshair(snapshot->session.tick.proxy.scp);
    for (SlicePane* pane : slices_) pane->show_snapshot(snapshot);
}

void Views::set_hand(bool probe) {
    scene_->set_hand(probe ? Scene::Hand::probe : Scene::Hand::camera);
    for (SlicePane* pane : slices_) pane->set_hand(probe);
}

void Views::set_crosshair(const Vec3& physical) {
    if (crosshair_ == physical) return;
    crosshair_ = physical;
    scene_->set_crosshair(physical);
    for (SlicePane* pane : slices_) pane->set_crosshair(physical);
}

/// By hand: then it stays there.
void Views::choose_crosshair(const Vec3& physical) {
    set_follow(false);
    set_crosshair(physical);
}

void Views::set_follow(bool follow) {
    if (follow_ == follow) return;
    follow_ = follow;
    Q_EMIT follow_changed(follow);
}

void Views::set_window(double low, double high) {
    window_low_ = low;
    window_high_ = high;
    for (SlicePane* pane : slices_) pane->set_window(low, high);
}

void Views::show_slices(bool shown) {
    down_->setVisible(shown);
}

bool Views::slices_shown() const {
    return !down_->isHidden();
}

}  // namespace palpate::viewer
