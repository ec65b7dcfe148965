// Labels over the scene, and numbers of loader and reader in words.
#include "apps/viewer/window/hints.hpp"

#include <QCoreApplication>
#include <QStringList>
#include <QUrl>

#include <algorithm>

#include "apps/viewer/model/hands.hpp"
#include "apps/viewer/model/measurement.hpp"
#include "apps/viewer/panel/colours.hpp"
#include "apps/viewer/panel/form.hpp"
#include "apps/viewer/panel/layout.hpp"
#include "apps/viewer/scene/scene.hpp"
#include "apps/viewer/window/content.hpp"
#include "apps/viewer/window/recording_controller.hpp"
#include "apps/viewer/window/views.hpp"

namespace palpate::viewer {
namespace {

struct Streaming {
    Q_DECLARE_TR_FUNCTIONS(Streaming)
};

QString level_text(const std::optional<int>& level) {
    return level ? QString::number(*level) : Streaming::tr("single samples");
}

}  // namespace

QString bytes_text(double bytes) {
    const double mega = bytes / 1e6;
    if (mega < 1000) return QString("%1 MB").arg(mega, 0, 'f', mega < 10 ? 1 : 0);
    return mega < 1e6 ? QString("%1 GB").arg(mega / 1e3, 0, 'f', 1)
                      : QString("%1 TB").arg(mega / 1e6, 0, 'f', 1);
}

QString streaming_words(const stream::BrickLoaderStatus& hand,
                        const DetailController::State& seen) {
    QStringList words{Streaming::tr("felt: level %1, seen: level %2")
                          .arg(QString::number(seen.felt), level_text(seen.finest))};
    if (hand.missing > 0) {
        words += Streaming::tr("%1 of %2 bricks missing").arg(hand.missing).arg(hand.wanted);
    }
    const auto& reading = seen.reading;
    if (reading.missing > 0) {
        words += Streaming::tr("%1 of %2 tiles missing").arg(reading.missing).arg(reading.wanted);
    }
    if (!hand.problem.empty() || !reading.problem.empty()) {
        words += Streaming::tr("cannot be read now, tried again");
    }
    words += bytes_text(double(hand.traffic.bytes));
    return words.join(" · ");
}

QString streaming_tip(const stream::BrickLoaderStatus& hand, const DetailController::State& seen) {
    const auto& reading = seen.reading;
    QStringList lines{
        Streaming::tr("The hand: %1 bricks in memory (%2), %3 wanted, %4 missing, %5 at once")
            .arg(hand.resident)
            .arg(bytes_text(double(hand.bytes)))
            .arg(hand.wanted)
            .arg(hand.missing)
            .arg(hand.urgent),
        Streaming::tr("Pictures: %1 tiles wanted, %2 missing, %3 coming, %4 failed; %5 in memory")
            .arg(reading.wanted)
            .arg(reading.missing)
            .arg(reading.coming)
            .arg(reading.failed)
            .arg(bytes_text(double(reading.bytes))),
        Streaming::tr("Read: %1 by %2 requests, %3 tried again, %4 found in the disk cache")
            .arg(bytes_text(double(hand.traffic.bytes)))
            .arg(hand.traffic.requests)
            .arg(hand.traffic.retries)
            .arg(hand.traffic.cached),
        Streaming::tr("The whole is seen at level %1").arg(level_text(seen.overview))};
    for (const std::string& problem : {hand.problem, reading.problem}) {
        const QString text = QString::fromStdString(problem);
        if (!text.isEmpty() && !lines.contains(text)) lines += text;
    }
    return lines.join('\n');
}

QString waiting_words(const stream::BrickLoaderStatus& hand) {
    if (!hand.problem.empty()) {
        return Streaming::tr("The hand waits: %1").arg(QString::fromStdString(hand.problem));
    }
    return Streaming::tr("The hand waits: %n brick(s) round it are being read", "",
                         static_cast<int>(hand.urgent > 0 ? hand.urgent : hand.missing));
}

namespace {

/// A label that lets the mouse through.
QLabel* label_over(QWidget& owner, const QString& name, const QString& style) {
    auto* label = named(new QLabel(&owner), name);
    label->setAttribute(Qt::WA_TransparentForMouseEvents);
    label->setStyleSheet("QLabel { border-radius: 4px; padding: 3px 8px; " + style + " }");
    label->hide();
    return label;
}

/// Shows words over a pane, with the label's middle there, but inside of it; hidden where there are
/// none. Words that are too wide for the pane are wrapped.
void say(QLabel& label, const QString& words, QWidget& owner, const QPoint& middle) {
    if (words.isEmpty()) return label.hide();
    if (label.parentWidget() != &owner) label.setParent(&owner);
    const bool fits =
        label.wordWrap() ? label.width() == owner.width() : label.width() <= owner.width();
    if (label.text() != words || !fits) {
        label.setWordWrap(false);
        label.setText(words);
        label.adjustSize();
        if (label.width() > owner.width()) {
            label.setWordWrap(true);
            label.resize(owner.width(), label.heightForWidth(owner.width()));
        }
    }
    const QPoint last(owner.width() - label.width(), owner.height() - label.height());
    QPoint corner = middle - label.rect().center();
    corner.setX(std::clamp(corner.x(), 0, std::max(0, last.x())));
    corner.setY(std::clamp(corner.y(), 0, std::max(0, last.y())));
    if (label.pos() != corner) label.move(corner);
    label.show();
}

}  // namespace

Hints::Hints(const Desk& desk, const RecordingController& recordings)
    : Controller(desk),
      recordings_(recordings),
      scene_(views_.scene()),
      notes_(label_over(scene_, "notes",
                        "background-color: rgba(255, 255, 225, 235); color: black; "
                        "border: 1px solid #b0a060;")),
      reason_(label_over(scene_, "hint", "background-color: #ffb000; color: black;")),
      brush_(label_over(scene_, "brush_on", "background-color: #d55e00; color: white;")),
      depth_(label_over(scene_, "depth", "background-color: rgba(0, 0, 0, 150); color: white;")),
      recording_(label_over(scene_, "recording_clock",
                            "background-color: rgba(0, 0, 0, 150); color: white;")) {
    for (int hand = 1; hand <= most_hands; ++hand) {
        const QString colour = to_qt(colours_of(hand).hip).name();
        numbers_[hand] = label_over(scene_, QString("hand_number_%1").arg(hand),
                                    "padding: 1px 4px; color: black; background-color: "
                                    "rgba(255, 255, 255, 190); border: 2px solid " +
                                        colour + ";");
    }
    notes_->setAttribute(Qt::WA_TransparentForMouseEvents, false);
    notes_->setCursor(Qt::ArrowCursor);
    notes_->setTextInteractionFlags(Qt::TextBrowserInteraction);
    connect(notes_, &QLabel::linkActivated, this, [this](const QString& text) {
        closed_notes_ << QUrl::fromPercentEncoding(text.toLatin1());
        notes_->hide();
    });
    connect(&recordings, &RecordingController::changed, this, [this] { recorded_.start(); });
}

void Hints::show_notes(const QList<const Note*>& notes) {
    QStringList shown, closed;  // one that comes again is said again
    for (const Note* note : notes) {
        const QString text = note->text();
        if (closed_notes_.contains(text)) {
            closed << text;
            continue;
        }
        const char* const colour = note->kind() == Note::Kind::warning ? "#aa2800" : "#000000";
        shown << QString(
                     "<span style='color: %1'>%2</span>&nbsp; <a href='%3' style='color: "
                     "black; text-decoration: none'><b>×</b></a>")
                     .arg(colour, text.toHtmlEscaped(), QUrl::toPercentEncoding(text));
    }
    closed_notes_ = closed;
    QWidget& pane = views_.main_pane();
    say(*notes_, shown.join("<br>"), pane, {pane.width() / 2, 0});
}

/// Why there is no force although the hand may expect one; empty: nothing holds it back. Data that
/// come within a moment need no words.
QString Hints::reason_of(const Snapshot& now) {
    constexpr qint64 moment_ms = 300;
    const bool waits = now.session.tick.proxy.status == UpdateStatus::waiting;
    if (!waits) waiting_.invalidate();
    if (waits && !waiting_.isValid()) waiting_.start();
    if (!now.forces_on) return tr("Forces are off: the space bar switches them on");
    if (now.session.frozen) return tr("Frozen: F lets hand and proxy move again");
    if (now.session.clutched) return tr("The volume hangs on the hand: C puts it down");
    if (now.session.device.status == DeviceStatus::finished) {
        return tr("The hand has come to its end: connect it again under Device");
    }
    if (waits && waiting_.elapsed() > moment_ms && content_.data()) {
        return waiting_words(content_.data()->streaming());
    }
    if (waits_for_hand(now)) return tr("Withdraw a little to feel forces again");
    return {};
}

void Hints::observe(const HandSnapshots& hands, bool brush) {
    const std::optional<Snapshot>& now = hands[content_.hand()];
    QWidget& pane = views_.main_pane();
    const int line = 2 * pane.fontMetrics().height();
    const bool live = content_.live() && now;
    const QString problem = problem_of_hands();
    const QString reason = !problem.isEmpty()    ? problem
                           : live                ? reason_of(*now)
                           : content_.playback() ? tr("A recording is played: Esc leaves it")
                                                 : QString();
    // Below the notes and the clock.
    const int top = notes_->isHidden() ? 0 : notes_->height();
    views_.place_missing(top);
    say(*reason_, reason, pane, {pane.width() / 2, top + 2 * line});
    say(*brush_,
        live && brush ? tr("The brush is on: it changes what it touches (B: off)") : QString(),
        pane, {pane.width() / 2, pane.height() - line});
    show_depth(live ? now : std::nullopt);
    show_numbers(hands);
    if (!recordings_.recording()) return recording_->hide();
    const auto seconds = recorded_.elapsed() / 1000;
    const QString clock = QString("<span style='color: #ff4040'>●</span> %1:%2")
                              .arg(seconds / 60)
                              .arg(seconds % 60, 2, 10, QChar('0'));
    say(*recording_, clock, pane, {pane.width() - 3 * line, top + line});
}

/// The problem of a device, with its hand if there are several. Empty if there is none.
QString Hints::problem_of_hands() const {
    QStringList words;
    for (int hand = 1; hand <= content_.hands() && content_.hands() > 1 && content_.live();
         ++hand) {
        const std::string problem = content_.live(hand)->device_problem();
        if (problem.empty()) continue;
        words << tr("Hand %1: %2").arg(hand).arg(QString::fromStdString(problem));
    }
    return words.join('\n');
}

/// Shows a number beside each hand, if there are several.
void Hints::show_numbers(const HandSnapshots& hands) {
    for (int hand = 1; hand <= most_hands; ++hand) {
        const auto& now = hands[hand];
        const bool shown = content_.hands() > 1 && now &&
                           now->session.device.status == DeviceStatus::ready &&
                           now->session.tick.proxy.hip.allFinite();
        if (!shown) {
            numbers_[hand]->hide();
            continue;
        }
        const Pixel at = pixel_of(scene_.camera(), scene_.view_size(), now->session.tick.proxy.hip);
        const int line = scene_.fontMetrics().height();
        say(*numbers_[hand], QString::number(hand), scene_,
            QPoint(int(at.x) + line, int(at.y) - line));
    }
}

/// Shows the depth beside the hand, while it presses with the mouse.
void Hints::show_depth(const std::optional<Snapshot>& now) {
    const bool presses = now && content_.live()->mouse() &&
                         now->session.tick.proxy.mode == Mode::constrained &&
                         now->session.tick.proxy.hip.allFinite();
    if (!presses) return depth_->hide();
    const ProxyUpdate& proxy = now->session.tick.proxy;
    const QString felt = felt_text(now->session.tick.layers, content_.layers());
    const QString layer = felt.isEmpty() ? QString() : felt + ": ";
    const Ruler ruler = ruler_of(content_.live()->field().geometry());
    const std::string depth = ruler.number((proxy.hip - proxy.scp).norm());
    const QString words = layer + tr("%1 %2 deep, %3 N")
                                      .arg(QString::fromStdString(depth),
                                           QCoreApplication::translate("Units", ruler.unit))
                                      .arg(now->session.tick.force.norm(), 0, 'f', 1);
    const Pixel hand = pixel_of(scene_.camera(), scene_.view_size(), proxy.hip);
    const int line = scene_.fontMetrics().height();
    say(*depth_, words, scene_, QPoint(int(hand.x), int(hand.y) + 3 * line));
}

}  // namespace palpate::viewer
