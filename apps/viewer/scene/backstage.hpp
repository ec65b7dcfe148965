// What the scene shows and who paints it: collects what was set, has it painted, keeps the newest
// picture. No widget, so that the widget is only about hands and pixels.
#pragma once

#include <QObject>
#include <QTimer>

#include <memory>
#include <optional>

#include "apps/viewer/scene/painter.hpp"
#include "apps/viewer/scene/shot.hpp"
#include "apps/viewer/scene/surface_work.hpp"

namespace palpate::viewer {

/// Lives in the window's thread. Two painters: a quick one, and one for fine pictures that may take
/// long and are given up when something changes.
class Backstage : public QObject {
    Q_OBJECT
  public:
    Backstage();
    ~Backstage() override;

    void set_field(const Field& field, double isovalue);
    /// As Scene has it.
    void update_field(const Field& field, const std::optional<SampleBox>& changed);
    void clear();
    void set_isovalue(double isovalue);
    /// Of what is painted next: all but number, field and surface, which are kept here. Paints only
    /// if it differs from what is shown or under way.
    void stage(const Shot& shot);

    const std::optional<Field>& field() const { return shot_.field; }
    /// Null before the first.
    const std::shared_ptr<const Backdrop>& shown() const { return shown_; }
    bool settled() const;
    double frame_seconds() const { return frame_seconds_; }

  Q_SIGNALS:
    /// shown() is another one.
    void painted();
    void surface_ready(double isovalue, double seconds);
    void problem(const QString& what);

  private:
    void start_painters();
    void paint();
    void take(Backdrop backdrop);
    void take(DrawnSurface surface);

    Shot shot_;
    std::shared_ptr<const Backdrop> shown_;
    std::uint64_t wish_ = 0, oldest_wish_ = 1;
    bool extracting_ = false;
    bool asked_ = false, announce_ = false;  // not by an update
    double isovalue_ = 0;
    double frame_seconds_ = 0;
    bool broken_ = false;  // no painter can paint
    QTimer rest_;
    SurfaceWork surface_work_;
    std::unique_ptr<Painter> quick_, fine_;
};

}  // namespace palpate::viewer
