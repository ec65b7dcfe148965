// Draws icons in a square of 24 units: lines and filled areas in one colour.
#include "apps/viewer/panel/icons.hpp"

#include <QGuiApplication>
#include <QIconEngine>
#include <QPainter>
#include <QPainterPath>
#include <QPalette>

#include <utility>

namespace palpate::viewer {
namespace {

constexpr double edge = 24;

struct Drawing {
    QPainterPath lines, areas;
};

Drawing mirrored(const Drawing& drawing) {
    const QTransform turn(-1, 0, 0, 1, edge, 0);
    return {turn.map(drawing.lines), turn.map(drawing.areas)};
}

void add_line(QPainterPath& path, std::initializer_list<QPointF> points,
              const QTransform& turn = {}) {
    path.addPolygon(turn.map(QPolygonF(QVector<QPointF>(points))));
}

void snowflake(Drawing& drawing) {
    for (int arm = 0; arm < 6; ++arm) {
        const QTransform turn = QTransform().translate(12, 12).rotate(60 * arm);
        add_line(drawing.lines, {{0, 0}, {0, -9.5}}, turn);
        add_line(drawing.lines, {{-2.8, -8.4}, {0, -5.8}, {2.8, -8.4}}, turn);
    }
}

void power_switch(Drawing& drawing) {
    const QRectF ring(4, 4.5, 16, 16);
    drawing.lines.arcMoveTo(ring, 125);
    drawing.lines.arcTo(ring, 125, 290);
    add_line(drawing.lines, {{12, 2.5}, {12, 12}});
}

void ball_on_a_surface(Drawing& drawing) {
    drawing.lines.moveTo(2, 20.5);
    drawing.lines.quadTo(12, 12.5, 22, 20.5);
    add_line(drawing.lines, {{12, 13.2}, {19.5, 3}});
    drawing.areas.addEllipse(QPointF(12, 13.2), 3, 3);
}

void brush(Drawing& drawing) {
    add_line(drawing.lines, {{21, 3}, {12.5, 12}});
    drawing.areas.moveTo(11, 11);
    drawing.areas.cubicTo(15, 12, 14, 17.5, 10, 19.5);
    drawing.areas.cubicTo(7.5, 20.7, 5, 20.7, 2.5, 20);
    drawing.areas.cubicTo(6, 18, 5, 12, 11, 11);
}

void arrow_back(Drawing& drawing) {
    drawing.lines.moveTo(4.5, 9);
    drawing.lines.lineTo(14.5, 9);
    drawing.lines.arcTo(QRectF(9.5, 9, 10, 10), 90, -180);
    drawing.lines.lineTo(8, 19);
    add_line(drawing.lines, {{9, 4.5}, {4.5, 9}, {9, 13.5}});
}

void ruler(Drawing& drawing) {
    drawing.lines.addRect(2, 7.5, 20, 9);
    for (const double x : {6.0, 10.0, 14.0, 18.0}) {
        add_line(drawing.lines, {{x, 7.5}, {x, x == 10 || x == 18 ? 12.5 : 11}});
    }
}

void scissors(Drawing& drawing) {
    for (const double side : {-1.0, 1.0}) {
        drawing.lines.addEllipse(QPointF(12 + 5 * side, 18), 3, 3);
        add_line(drawing.lines, {{12 + 3.4 * side, 15.5}, {12 - 5 * side, 2.5}});
    }
}

void panes(Drawing& drawing) {
    drawing.lines.addRect(3, 4, 18, 16);
    add_line(drawing.lines, {{14, 4}, {14, 20}});
    for (const double y : {9.3, 14.7}) add_line(drawing.lines, {{14, y}, {21, y}});
}

void ball_in_a_frame(Drawing& drawing) {
    for (int corner = 0; corner < 4; ++corner) {
        const QTransform turn = QTransform().translate(12, 12).rotate(90 * corner);
        add_line(drawing.lines, {{-9, -4.5}, {-9, -9}, {-4.5, -9}}, turn);
    }
    drawing.areas.addEllipse(QPointF(12, 12), 4.5, 4.5);
}

void eye(Drawing& drawing) {
    drawing.lines.moveTo(2, 12);
    drawing.lines.quadTo(12, 2, 22, 12);
    drawing.lines.quadTo(12, 22, 2, 12);
    drawing.areas.addEllipse(QPointF(12, 12), 3.3, 3.3);
}

void folder(Drawing& drawing) {
    add_line(drawing.lines, {{3, 19}, {3, 5}, {9, 5}, {11, 8}, {21, 8}, {21, 19}, {3, 19}});
}

void ring_and_dot(Drawing& drawing) {
    drawing.lines.addEllipse(QPointF(12, 12), 9, 9);
    drawing.areas.addEllipse(QPointF(12, 12), 5, 5);
}

void bars(Drawing& drawing) {
    for (const double x : {5.3, 13.9}) drawing.areas.addRect(x, 3.6, 4.8, 16.8);
}

void triangle(Drawing& drawing) {
    add_line(drawing.areas, {{6, 2.9}, {6, 21.1}, {20.4, 12}});
}

void bar_and_triangle(Drawing& drawing) {
    drawing.areas.addRect(4.8, 4.8, 3.1, 14.4);
    add_line(drawing.areas, {{10, 4.3}, {10, 19.7}, {20.4, 12}});
}

/// In the order of Shape; with whether it is mirrored.
constexpr std::pair<void (*)(Drawing&), bool> drawings[] = {{bar_and_triangle, true},
                                                            {brush, false},
                                                            {scissors, false},
                                                            {eye, false},
                                                            {power_switch, false},
                                                            {bar_and_triangle, false},
                                                            {snowflake, false},
                                                            {panes, false},
                                                            {ruler, false},
                                                            {folder, false},
                                                            {bars, false},
                                                            {triangle, false},
                                                            {ring_and_dot, false},
                                                            {arrow_back, true},
                                                            {ball_on_a_surface, false},
                                                            {arrow_back, false},
                                                            {ball_in_a_frame, false}};

Drawing drawing_of(Shape shape) {
    const auto& [draw, is_mirrored] = drawings[static_cast<std::size_t>(shape)];
    Drawing drawing;
    draw(drawing);
    return is_mirrored ? mirrored(drawing) : drawing;
}

class Engine : public QIconEngine {
  public:
    explicit Engine(Shape shape) : shape_(shape), drawing_(drawing_of(shape)) {}

    void paint(QPainter* painter, const QRect& rect, QIcon::Mode mode, QIcon::State) override {
        const auto group = mode == QIcon::Disabled ? QPalette::Disabled : QPalette::Active;
        const QColor ink = QGuiApplication::palette().color(group, QPalette::ButtonText);
        painter->save();
        painter->setRenderHint(QPainter::Antialiasing);
        painter->translate(rect.topLeft());
        painter->scale(rect.width() / edge, rect.height() / edge);
        painter->fillPath(drawing_.areas, ink);
        painter->setBrush(Qt::NoBrush);
        painter->setPen(QPen(ink, 1.8, Qt::SolidLine, Qt::RoundCap, Qt::RoundJoin));
        painter->drawPath(drawing_.lines);
        painter->restore();
    }
    QPixmap pixmap(const QSize& size, QIcon::Mode mode, QIcon::State state) override {
        QPixmap picture(size);
        picture.fill(Qt::transparent);
        QPainter painter(&picture);
        paint(&painter, picture.rect(), mode, state);
        return picture;
    }
    QIconEngine* clone() const override { return new Engine(shape_); }

  private:
    Shape shape_;
    Drawing drawing_;
};

}  // namespace

QIcon icon_of(Shape shape) {
    return QIcon(new Engine(shape));
}

}  // namespace palpate::viewer
