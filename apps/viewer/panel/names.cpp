// Looks names up among the translations.
#include "apps/viewer/panel/names.hpp"

#include <QComboBox>
#include <QCoreApplication>

namespace palpate::viewer {
namespace {

/// Words of this file. The names stand here for the translators alone.
struct Names {
    Q_DECLARE_TR_FUNCTIONS(Names)

    [[maybe_unused]] static constexpr const char* to_translate[] = {
        // transfer functions
        QT_TR_NOOP("CT bone"), QT_TR_NOOP("CT skin"), QT_TR_NOOP("CT soft tissue"),
        QT_TR_NOOP("Dense parts"), QT_TR_NOOP("Outer surface"), QT_TR_NOOP("Soft parts"),
        QT_TR_NOOP("MR"), QT_TR_NOOP("Microscopy"), QT_TR_NOOP("Grey"),
        // colour maps
        QT_TR_NOOP("grey"), QT_TR_NOOP("hot"), QT_TR_NOOP("bone"), QT_TR_NOOP("viridis"),
        QT_TR_NOOP("cool-warm"), QT_TR_NOOP("spectrum"),
        // causes of slow ticks
        QT_TR_NOOP("none"), QT_TR_NOOP("the machine"), QT_TR_NOOP("the device"),
        QT_TR_NOOP("the proxy update"), QT_TR_NOOP("the rest of the tick"), QT_TR_NOOP("unknown")};
};

}  // namespace

QString shown_name(const std::string& name) {
    return Names::tr(name.c_str());
}

QString shown_set(const std::string& name) {
    const QString text = QString::fromStdString(name);
    if (text.isEmpty() || text == "Own layers") return Names::tr("Own layers");
    if (const QString begin("Labels of "); text.startsWith(begin)) {
        return Names::tr("Labels of %1").arg(text.mid(begin.size()));
    }
    if (const QString end(", by label"); text.endsWith(end)) {
        return Names::tr("%1, by label").arg(text.chopped(end.size()));
    }
    return text;
}

QString felt_text(const LayersFelt& felt, const SharedLayers& layers) {
    const FeltWords words{Names::tr("on %1").toStdString(), Names::tr("in %1").toStdString(),
                          Names::tr("on %1, in %2").toStdString(),
                          Names::tr("on %1, from inside").toStdString()};
    return QString::fromStdString(felt_words(felt, layers, words));
}

void add_choice(QComboBox& box, const std::string& name) {
    box.addItem(shown_name(name), QString::fromStdString(name));
}

}  // namespace palpate::viewer
