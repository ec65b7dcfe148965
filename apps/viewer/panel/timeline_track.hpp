// The slider of a timeline: of a sequence it shows the frames and what is in memory, of a recording
// force (green), isovalue (grey) where it changes, and contact (vermilion bar below).
#pragma once

#include <QAbstractSlider>

#include "apps/viewer/panel/timeline_view.hpp"

namespace palpate::viewer {

/// A click or drag chooses a time; arrows step to the frames beside it, Page Up and Down go by a
/// tenth of the whole, Home and End to the ends. As a slider its value counts milliseconds from the
/// begin.
class TimelineTrack : public QAbstractSlider {
    Q_OBJECT

  public:
    TimelineTrack();

    /// All but the time; emits nothing. True if times or frames are others than before.
    bool set_view(const TimelineView& view);
    const TimelineView& view() const { return view_; }
    /// [s], between begin and end.
    double time() const { return time_; }
    /// [s]; brought within begin and end. Emits nothing.
    void set_time(double time);

    QSize sizeHint() const override;
    QSize minimumSizeHint() const override;

  Q_SIGNALS:
    /// By the user [s].
    void chosen(double time);
    /// A frame forward (1) or back (-1).
    void stepped(int direction);

  protected:
    bool event(QEvent* event) override;
    void paintEvent(QPaintEvent* event) override;
    void keyPressEvent(QKeyEvent* event) override;
    void mousePressEvent(QMouseEvent* event) override;
    void mouseMoveEvent(QMouseEvent* event) override;
    void mouseReleaseEvent(QMouseEvent* event) override;
    void sliderChange(SliderChange change) override;

  private:
    double length() const;
    QRectF plot() const;
    double x_of(double time) const;
    double time_at(double x) const;
    void choose_at(double x);
    void place();
    void paint_loaded(QPainter& painter, const QRectF& box) const;
    void paint_frames(QPainter& painter, const QRectF& box) const;
    void paint_overview(QPainter& painter, const QRectF& box) const;

    TimelineView view_;
    double time_ = 0;
    bool telling_ = true;
};

}  // namespace palpate::viewer
