// Puts numbers of loader and reader into words.
#include "apps/viewer/window/streaming_words.hpp"

#include <QCoreApplication>
#include <QStringList>

namespace palpate::viewer {
namespace {

/// Words of this file.
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

}  // namespace palpate::viewer
