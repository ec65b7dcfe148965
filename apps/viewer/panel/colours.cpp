// Draws the swatch, opens the colour dialog, and draws icons in a square of 24 units: lines and
// filled areas in one colour.
#include "apps/viewer/panel/colours.hpp"

#include <QColorDialog>
#include <QGuiApplication>
#include <QIconEngine>
#include <QPainter>
#include <QPainterPath>
#include <QPalette>
#include <array>
#include <cctype>
#include <sstream>
#include <string_view>

namespace palpate::viewer {

bool is_dark(const QPalette& palette) {
    return palette.color(QPalette::Window).lightnessF() < 0.5;
}

QColor readable(const QColor& colour, const QPalette& palette) {
    if (is_dark(palette)) return colour.lighter(155);
    return colour.lightnessF() > 0.6 ? colour.darker(160) : colour;
}

QIcon icon_of(const Colour& colour) {
    QPixmap square(16, 16);
    square.fill(to_qt(colour));
    QIcon icon(square);
    icon.addPixmap(square, QIcon::Selected);
    return icon;
}

ColourButton::ColourButton(const QString& name, const QString& title) {
    setObjectName(name);
    setAccessibleName(title);
    setToolTip(title);
    setMinimumWidth(3 * fontMetrics().height());
    connect(this, &QPushButton::clicked, this, &ColourButton::choose);
}

void ColourButton::set_colour(const Colour& colour) {
    if (colour == colour_) return;
    colour_ = colour;
    update();
}

void ColourButton::choose() {
    auto* dialog = new QColorDialog(to_qt(colour_), this);
    dialog->setObjectName(objectName() + "_dialog");
    dialog->setWindowTitle(accessibleName());
    dialog->setOption(QColorDialog::DontUseNativeDialog);
    dialog->setAttribute(Qt::WA_DeleteOnClose);
    const Colour before = colour_;
    const auto want = [this](const Colour& colour) {
        if (colour == colour_) return;
        set_colour(colour);
        Q_EMIT wanted(colour);
    };
    connect(dialog, &QColorDialog::currentColorChanged, this,
            [want](const QColor& colour) { want(from_qt(colour)); });
    connect(dialog, &QColorDialog::rejected, this, [want, before] { want(before); });
    dialog->open();
}

void ColourButton::paintEvent(QPaintEvent* event) {
    QPushButton::paintEvent(event);
    QPainter painter(this);
    painter.setRenderHint(QPainter::Antialiasing);
    const double inset = 0.25 * fontMetrics().height();
    painter.setOpacity(isEnabled() ? 1 : 0.4);
    painter.setBrush(to_qt(colour_));
    painter.setPen(QPen(palette().color(QPalette::ButtonText), 1));
    painter.drawRoundedRect(QRectF(rect()).adjusted(inset, inset, -inset, -inset), 2, 2);
}

namespace {

constexpr double edge = 24;

/// Paths of letters with numbers: M and L x y; Q and C with one and two control points; an arc A of
/// the ellipse in a rectangle from an angle by another, G goes to where it begins; an ellipse E x y
/// r; a rectangle R x y width height.
struct Drawing {
    const char *lines, *areas;
    int turns = 1;  ///< copies, turned about the middle
    bool mirrored = false;
};

constexpr const char* arrow =
    "M 4.5 9 L 14.5 9 A 9.5 9 10 10 90 -180 L 8 19 M 9 4.5 L 4.5 9 9 13.5";
constexpr const char* step = "R 4.8 4.8 3.1 14.4 M 10 4.3 L 10 19.7 20.4 12";

/// In the order of Shape.
constexpr Drawing drawings[] = {
    {"", step, 1, true},
    {"M 21 3 L 12.5 12", "M 11 11 C 15 12 14 17.5 10 19.5 7.5 20.7 5 20.7 2.5 20 6 18 5 12 11 11"},
    {"E 7 18 3 M 8.6 15.5 L 17 2.5 E 17 18 3 M 15.4 15.5 L 7 2.5", ""},
    {"M 2 12 Q 12 2 22 12 12 22 2 12", "E 12 12 3.3"},
    {"G 4 4.5 16 16 125 A 4 4.5 16 16 125 290 M 12 2.5 L 12 12", ""},
    {"", step},
    {"M 12 12 L 12 2.5 M 9.2 3.6 L 12 6.2 14.8 3.6", "", 6},
    {"R 3 4 18 16 M 14 4 L 14 20 M 14 9.3 L 21 9.3 M 14 14.7 L 21 14.7", ""},
    {"R 2 7.5 20 9 M 6 7.5 L 6 11 M 10 7.5 L 10 12.5 M 14 7.5 L 14 11 M 18 7.5 L 18 12.5", ""},
    {"M 3 19 L 3 5 9 5 11 8 21 8 21 19 3 19", ""},
    {"", "R 5.3 3.6 4.8 16.8 R 13.9 3.6 4.8 16.8"},
    {"", "M 6 2.9 L 6 21.1 20.4 12"},
    {"E 12 12 9", "E 12 12 5"},
    {arrow, "", 1, true},
    {"M 2 20.5 Q 12 12.5 22 20.5 M 12 13.2 L 19.5 3", "E 12 13.2 3"},
    {arrow, ""},
    {"M 3 7.5 L 3 3 7.5 3", "E 12 12 4.5", 4}};

QPainterPath path_of(const char* text) {
    QPainterPath path;
    std::istringstream in(text);
    char op = 0;
    while (!(in >> std::ws).eof()) {
        if (std::isalpha(in.peek())) in >> op;  // else one more of the same
        std::array<double, 6> n{};
        const std::string_view ops = "MLEQRGCA";
        constexpr std::size_t counts[] = {2, 2, 3, 4, 4, 5, 6, 6};
        for (std::size_t i = 0; i < counts[ops.find(op)]; ++i) in >> n[i];
        const QRectF box(n[0], n[1], n[2], n[3]);
        if (op == 'M') path.moveTo(n[0], n[1]);
        if (op == 'L') path.lineTo(n[0], n[1]);
        if (op == 'E') path.addEllipse(QPointF(n[0], n[1]), n[2], n[2]);
        if (op == 'Q') path.quadTo(n[0], n[1], n[2], n[3]);
        if (op == 'R') path.addRect(box);
        if (op == 'G') path.arcMoveTo(box, n[4]);
        if (op == 'C') path.cubicTo(n[0], n[1], n[2], n[3], n[4], n[5]);
        if (op == 'A') path.arcTo(box, n[4], n[5]);
    }
    return path;
}

QPainterPath drawn(const char* text, const Drawing& drawing) {
    const QPainterPath one = path_of(text);
    QPainterPath all;
    all.setFillRule(Qt::WindingFill);
    for (int i = 0; i < drawing.turns; ++i) {
        QTransform turn = QTransform().translate(12, 12).rotate(360.0 / drawing.turns * i);
        all.addPath(turn.translate(-12, -12).map(one));
    }
    return drawing.mirrored ? QTransform(-1, 0, 0, 1, edge, 0).map(all) : all;
}

class Engine : public QIconEngine {
  public:
    explicit Engine(const Drawing& drawing)
        : lines_(drawn(drawing.lines, drawing)), areas_(drawn(drawing.areas, drawing)) {}

    void paint(QPainter* painter, const QRect& rect, QIcon::Mode mode, QIcon::State) override {
        const auto group = mode == QIcon::Disabled ? QPalette::Disabled : QPalette::Active;
        const QColor ink = QGuiApplication::palette().color(group, QPalette::ButtonText);
        painter->save();
        painter->setRenderHint(QPainter::Antialiasing);
        painter->translate(rect.topLeft());
        painter->scale(rect.width() / edge, rect.height() / edge);
        painter->fillPath(areas_, ink);
        painter->setBrush(Qt::NoBrush);
        painter->setPen(QPen(ink, 1.8, Qt::SolidLine, Qt::RoundCap, Qt::RoundJoin));
        painter->drawPath(lines_);
        painter->restore();
    }
    QPixmap pixmap(const QSize& size, QIcon::Mode mode, QIcon::State state) override {
        QPixmap picture(size);
        picture.fill(Qt::transparent);
        QPainter painter(&picture);
        paint(&painter, picture.rect(), mode, state);
        return picture;
    }
    QIconEngine* clone() const override { return new Engine(*this); }

  private:
    QPainterPath lines_, areas_;
};

}  // namespace

QIcon icon_of(Shape shape) {
    return QIcon(new Engine(drawings[static_cast<std::size_t>(shape)]));
}

}  // namespace palpate::viewer
