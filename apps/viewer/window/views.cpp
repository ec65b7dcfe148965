// Lays out the scene and the slices side by side, and keeps them in step.
#include "apps/viewer/window/views.hpp"

#include <QApplication>
#include <QBoxLayout>
#include <QMouseEvent>
#include <QPushButton>
#include <QSplitter>
#include <algorithm>
#include <cmath>
#include <utility>

#include "apps/viewer/model/probe_route.hpp"
#include "apps/viewer/model/sample_block.hpp"
#include "apps/viewer/panel/layout.hpp"
#include "apps/viewer/scene/cut.hpp"
#include "apps/viewer/scene/scene.hpp"
#include "apps/viewer/slices/slice_pane.hpp"

namespace palpate::viewer {

/// Tells the scene and each slice.
template <class Tell>
void Views::in_all(Tell tell) {
    tell(*scene_);
    for (SlicePane* pane : slices_) tell(*pane);
}

Views::Views(MakePainter make_painter, QWidget* parent)
    : QWidget(parent),
      scene_(new Scene(nullptr, std::move(make_painter))),
      slices_{new SlicePane(0), new SlicePane(1), new SlicePane(2)},
      by_body_(slices_),
      missing_(named(new QPushButton(scene_), "missing_grid")),
      across_(new QSplitter(Qt::Horizontal)),
      left_(new QSplitter(Qt::Vertical)),
      down_(new QSplitter(Qt::Vertical)) {
    column_in(this, {across_});
    scene_->setObjectName("scene");
    scene_->setMinimumSize(200, 200);
    left_->addWidget(scene_);
    across_->addWidget(left_);
    across_->addWidget(down_);
    across_->setStretchFactor(0, 3);
    across_->setStretchFactor(1, 1);
    scene_->installEventFilter(this);
    for (const std::size_t axis : {0U, 1U, 2U}) {
        SlicePane* pane = slices_[axis];
        pane->setObjectName(QString("slice%1").arg(axis));
        pane->installEventFilter(this);
        connect(pane, &SlicePane::crosshair_chosen, this, &Views::choose_crosshair);
        connect(pane, &SlicePane::probe_aimed, this, &Views::probe_aimed);
        connect(pane, &SlicePane::probe_dragged, this, &Views::probe_dragged);
        connect(pane, &SlicePane::window_chosen, this,
                [this](const GreyWindow& window) { set(*this, &Shown::window, window); });
        connect(pane, &SlicePane::point_chosen, this, &Views::point_chosen);
        connect(pane, &SlicePane::point_pointed_at, this, &Views::point_pointed_at);
    }
    connect(scene_, &Scene::probe_dragged, this, &Views::probe_dragged);
    connect(scene_, &Scene::point_chosen, this, [this](const Vec3& seen) {
        if (const auto at = on_surface(seen)) Q_EMIT point_chosen(*at);
    });
    connect(scene_, &Scene::point_pointed_at, this, [this](const Vec3& seen) {
        if (const auto at = on_surface(seen)) Q_EMIT point_pointed_at(*at);
    });
    arrange(Arrangement::beside);
    missing_->setStyleSheet(
        "QPushButton { background-color: #ffb000; color: black; border-radius: 4px; "
        "padding: 3px 8px; }");
    missing_->setCursor(Qt::ArrowCursor);
    missing_->hide();
    connect(missing_, &QPushButton::clicked, this, &Views::missing_asked);
}

void Views::set_missing(const QString& words, const QString& tip) {
    missing_->setText(words);
    missing_->setToolTip(tip);
    missing_->setAccessibleName(tip);
    missing_->setVisible(!words.isEmpty());
}

void Views::place_missing(int top) {
    QWidget& pane = main_pane();
    if (missing_->parentWidget() != &pane) {
        missing_->setParent(&pane);
        missing_->setVisible(!missing_->text().isEmpty());
    }
    if (missing_->isHidden()) return;
    missing_->resize(missing_->sizeHint().boundedTo(pane.size()));
    const int letters = 2 * pane.fontMetrics().height();
    missing_->move(0, &pane == scene_ ? top : pane.height() - missing_->height() - letters);
}

/// The picture may be much coarser than the surfaces: of those that are drawn, the point in front
/// of them all that is nearest to what is seen. Nothing where they are only in the picture. Other
/// things that are drawn, and what a cut has opened, are where they are seen.
std::optional<Vec3> Views::on_surface(const Vec3& seen) const {
    const Look look = scene_look(shown_.look, shown_.layers);
    const Geometry& geometry = field_->geometry();
    const Vec3 towards = axes_of(scene_->camera()).towards_viewer;
    const auto cuts = planes_of(look, geometry);
    std::vector<double> levels;
    if (look.surface) levels.push_back(shown_.isovalue);
    if (shown_.pressed) levels.push_back(*shown_.pressed);
    for (const SeenSurface& one : look.surfaces) {
        if (one.shown) levels.push_back(one.level);
    }
    const auto depth_off = [&](const Vec3& at) { return std::abs((at - seen).dot(towards)); };
    std::optional<Vec3> nearest;
    for (const double level : levels) {
        const auto met = surface_under(*field_, level, seen, towards, cuts);
        if (met && (!nearest || depth_off(*met) < depth_off(*nearest))) nearest = met;
    }
    const bool has_others = look.volume || look.slices ||
                            (shown_.overlay && look.overlay.shown && look.overlay.surface);
    if (!has_others && (nearest || cuts.empty())) return nearest;
    const double near = 1.5 * geometry.spacing.maxCoeff();
    return nearest && depth_off(*nearest) <= near ? nearest : seen;
}

/// Whether this press follows a double click at once, at the same place, as the third or fourth
/// one of a hurried hand does.
bool Views::follows_double_click(const QMouseEvent& press) {
    const auto interval = static_cast<ulong>(QApplication::doubleClickInterval());
    const bool follows =
        clicked_twice_ && press.timestamp() - pressed_time_ <= interval &&
        (press.globalPos() - pressed_).manhattanLength() < QApplication::startDragDistance();
    clicked_twice_ = follows || press.type() == QEvent::MouseButtonDblClick;
    pressed_time_ = press.timestamp();
    pressed_ = press.globalPos();
    return follows;
}

/// Of all panes, as the next click of several may go to another one.
bool Views::eventFilter(QObject* watched, QEvent* event) {
    const bool twice = event->type() == QEvent::MouseButtonDblClick;
    if (twice || event->type() == QEvent::MouseButtonPress) {
        const auto& mouse = static_cast<const QMouseEvent&>(*event);
        const bool left = mouse.button() == Qt::LeftButton;
        if (left && follows_double_click(mouse)) return true;
        if (left && !twice) {
            crosshair_before_ = shown_.crosshair;
            follow_before_ = follow_;
        }
        if (twice && left && mouse.modifiers() == Qt::NoModifier) {
            if (watched != scene_) restore_crosshair();
            Q_EMIT double_clicked();
            toggle_alone(static_cast<QWidget*>(watched));
            return true;
        }
    }
    return QWidget::eventFilter(watched, event);
}

/// The first click of a double click has moved it.
void Views::restore_crosshair() {
    set_follow(follow_before_);
    set(*this, &Shown::crosshair, crosshair_before_);
}

void Views::toggle_alone(QWidget* pane) {
    alone_ = alone_ ? nullptr : pane;
    show_panes();
}

QWidget& Views::main_pane() {
    return alone_ ? *alone_ : *scene_;
}

void Views::show_next_slice() {
    const auto at = std::ranges::find(slices_, alone_);
    const auto now = at - slices_.begin();  // 3: none
    alone_ = slices_[static_cast<std::size_t>((now + 2) % 3)];
    show_panes();
}

/// Axial above, as is usual, whatever the order of storage.
void Views::order_panes() {
    const auto before = by_body_;
    for (SlicePane* pane : slices_) by_body_[std::size_t(pane->anatomical())] = pane;
    if (by_body_ != before) arrange(arrangement_);
}

void Views::arrange(Arrangement arrangement) {
    arrangement_ = arrangement;
    alone_ = nullptr;
    slices_shown_ = true;
    const bool four = arrangement == Arrangement::four;
    // Above one another in every arrangement: axial, coronal, sagittal.
    for (const std::size_t pane : {2U, 1U}) down_->addWidget(by_body_[pane]);
    (four ? left_ : down_)->addWidget(by_body_[0]);
    show_panes();
    const int part = four ? 1 : 3;
    across_->setSizes({part * 300, 300});
    left_->setSizes({300, 300});
    down_->setSizes({300, 300, 300});
}

/// A splitter whose panes are all hidden is hidden, or it would keep its room.
void Views::show_panes() {
    const auto seen = [this](const QWidget* pane) {
        return alone_ ? pane == alone_ : pane == scene_ || slices_shown_;
    };
    scene_->setVisible(seen(scene_));
    for (SlicePane* pane : slices_) pane->setVisible(seen(pane));
    left_->setVisible(seen(scene_) || (by_body_[0]->parent() == left_ && seen(by_body_[0])));
    down_->setVisible(!alone_ ? slices_shown_ : alone_->parent() == down_);
}

void Views::set_field(const Field& field, double isovalue, const std::optional<Geometry>& counted) {
    shown_ = with_field(shown_, field_ ? &*field_ : nullptr, field, isovalue);
    field_ = field;
    scene_->set_field(field, isovalue);
    for (SlicePane* pane : slices_) pane->set_field(field, isovalue, counted);
    order_panes();
    touched_ = false;
}

void Views::update_field(const Field& field) {
    if (same_samples(*field_, field)) return;
    field_ = field;
    in_all([&](auto& pane) { pane.update_field(field); });
}

void Views::clear() {
    field_.reset();
    in_all([](auto& pane) { pane.clear(); });
}

void Views::set_shown(const Shown& shown) {
    shown_ = shown;
    in_all([this](auto& pane) { pane.set_shown(shown_); });
}

void Views::show_snapshots(const HandSnapshots& hands, int chosen) {
    const std::optional<Snapshot>& snapshot = hands[chosen];
    const bool placed = snapshot && snapshot->session.device.status == DeviceStatus::ready &&
                        snapshot->session.tick.proxy.scp.allFinite();
    touched_ = touched_ || (placed && snapshot->session.tick.proxy.mode == Mode::constrained);
    if (placed && follow_ && touched_) {
        set(*this, &Shown::crosshair, snapshot->session.tick.proxy.scp);
    }
    for (int hand = 1; hand <= most_hands; ++hand) {
        in_all([&](auto& pane) { pane.show_snapshot(hands[hand], hand); });
    }
}

/// By hand: then it stays there.
void Views::choose_crosshair(const Vec3& physical) {
    set_follow(false);
    set(*this, &Shown::crosshair, physical);
}

void Views::show_slices(bool shown) {
    slices_shown_ = shown;
    show_panes();
}

}  // namespace palpate::viewer
