// Recognizes sentences by patterns, and translates these.
#include "apps/viewer/panel/sentences.hpp"

#include <QCoreApplication>
#include <QRegularExpression>

namespace palpate::viewer {
namespace {

/// The parts %1, %2, ... come in this order, and are looked up as well.
struct Sentences {
    Q_DECLARE_TR_FUNCTIONS(Sentences)
  public:
    static constexpr const char* all[] = {
        QT_TR_NOOP("%1 = %2: must be %3"),
        QT_TR_NOOP("the isovalue lies outside the data's range: nothing is solid, so there is "
                   "nothing to touch"),
        QT_TR_NOOP("the background outside the data is solid at this isovalue: all of space "
                   "outside the data will be solid (choose another isovalue or background)"),
        QT_TR_NOOP("%1: the data is constant, so there is no surface to touch"),
        QT_TR_NOOP("%1 does not give its orientation, and %2 does: left and right of one of them "
                   "may be mirrored (palpate convert %3 OUT --orientation RAS writes it with one)"),
        QT_TR_NOOP("%1 does not give its spacing, and %2 does: they may differ in size (palpate "
                   "convert %3 OUT --spacing X,Y,Z writes it with one)"),
        QT_TR_NOOP("the layers are in %1; %2 does not say what its densities are in"),
        QT_TR_NOOP("the layers are in %1; %2 is in %3"),
        QT_TR_NOOP("these layers lie outside the densities of %1: %2"),
        QT_TR_NOOP("there is not enough memory for the surface"),
        QT_TR_NOOP("the isovalue is not finite"),
        QT_TR_NOOP("the isovalue is not a number, or infinite so that all of space is solid"),
        QT_TR_NOOP("the penetration threshold must be at least 0 mm, not %1"),
        QT_TR_NOOP("a range of interest needs low <= high, not %1 to %2"),
        QT_TR_NOOP("friction: needs 0 <= dynamic coefficient <= static coefficient"),
        QT_TR_NOOP("tools need the cubic field: a linear one can be touched only with a point"),
        QT_TR_NOOP("a tool cannot be combined with %1: use only one of the two"),
        QT_TR_NOOP("layers"), QT_TR_NOOP("penetrability"), QT_TR_NOOP("a magnet"),
        QT_TR_NOOP("a texture"), QT_TR_NOOP("layer \"%1\" is there twice"),
        QT_TR_NOOP("layer \"%1\": its level must be finite"),
        QT_TR_NOOP("layer \"%1\": levels must rise from layer to layer, from outside in"),
        QT_TR_NOOP("layer \"%1\": levels must fall from layer to layer, from outside in"),
        QT_TR_NOOP("layer %1 has no name"), QT_TR_NOOP("real-time priority: SCHED_FIFO %1"),
        QT_TR_NOOP("real-time priority: not granted (%1); allow it with a line '@audio - rtprio "
                   "90' in /etc/security/limits.d and your user in that group"),
        QT_TR_NOOP("memory: locked"),
        // what a number must be
        QT_TR_NOOP("a number"), QT_TR_NOOP("finite"), QT_TR_NOOP("from %1 to %2"),
        QT_TR_NOOP("finite and at least %1"), QT_TR_NOOP("finite and above 0"),
        QT_TR_NOOP("above 0 (inf: none)"), QT_TR_NOOP("at least 0 (inf: none)"),
        QT_TR_NOOP("at least 0 (inf: start at any)"),
        QT_TR_NOOP("at most %1 at %2 Hz and a delay of %3 ms to be rendered stably"),
        QT_TR_NOOP("at most %1 at %2 Hz to be rendered stably"),
        QT_TR_NOOP("at most %1 over this distance"),
        QT_TR_NOOP("below the physical damping of device and hand, %1"),
        QT_TR_NOOP("below the physical rotational damping of device and hand, %1"),
        // numbers
        QT_TR_NOOP("stiffness [N/mm]"), QT_TR_NOOP("damping [N s/mm]"),
        QT_TR_NOOP("damping + viscosity [N s/mm]"), QT_TR_NOOP("viscosity [N s/mm]"),
        QT_TR_NOOP("force limit [N]"), QT_TR_NOOP("force rate limit [N/s]"),
        QT_TR_NOOP("force ramp [s]"), QT_TR_NOOP("force to start below [N]"),
        QT_TR_NOOP("stale time [s]"), QT_TR_NOOP("magnet peak [N]"),
        QT_TR_NOOP("rotational stiffness [N mm/rad]"),
        QT_TR_NOOP("rotational damping [N mm s/rad]"), QT_TR_NOOP("torque limit [N mm]"),
        QT_TR_NOOP("torque rate limit [N mm/s]")};
};

QString translated(const QString& sentence) {
    for (const char* const pattern : Sentences::all) {
        QString form = QRegularExpression::escape(pattern);
        form.replace(QRegularExpression("\\\\%\\d"), "(.+)");
        const auto match =
            QRegularExpression(QRegularExpression::anchoredPattern(form)).match(sentence);
        if (!match.hasMatch()) continue;
        QString words = Sentences::tr(pattern);
        for (int part = 1; part <= match.lastCapturedIndex(); ++part) {
            words.replace(QString("%%1").arg(part), translated(match.captured(part)));
        }
        return words;
    }
    return sentence;
}

}  // namespace

QString in_words(const std::string& sentence) {
    return translated(QString::fromStdString(sentence));
}

}  // namespace palpate::viewer
