// The slider of a sequence: its time, with frames and what is in memory drawn on it.
#pragma once

#include <QAbstractSlider>

#include "apps/viewer/panel/sequence_view.hpp"

namespace palpate::viewer {

/// A click or drag chooses a time; arrows step to the frames beside it, Page Up and Down go by a
/// tenth of the whole, Home and End to the ends. As a slider its value counts milliseconds from the
/// begin.
class SequenceTrack : public QAbstractSlider {
    Q_OBJECT

  public:
    explicit SequenceTrack(QWidget* parent = nullptr);

    /// All but the time. Tells nobody. True if times or frames are others than before.
    bool set_view(const SequenceView& view);
    const SequenceView& view() const { return view_; }
    /// [s], between begin and end.
    double time() const { return time_; }
    /// [s]; what is outside goes round or to the ends. Tells nobody.
    void set_time(double time);
    /// "1.60 s, frame 3 of 6".
    QString text_at(double time) const;

    QSize sizeHint() const override;
    QSize minimumSizeHint() const override;

  Q_SIGNALS:
    /// By the person [s].
    void chosen(double time);
    /// A frame on (1) or back (-1).
    void stepped(int way);

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
    void paint_frames(QPainter& painter, const QRectF& box) const;
    void place();

    SequenceView view_;
    double time_ = 0;
    int digits_ = 2;  // of a time, behind the point
    bool telling_ = true;
};

}  // namespace palpate::viewer
