// What the window says about a volume that is read as it is felt.
#pragma once

#include <QString>

#include "apps/viewer/window/detail_controller.hpp"
#include "palpate/stream/loader.hpp"

namespace palpate::viewer {

/// "12 MB".
QString bytes_text(double bytes);
/// A line for the status bar: levels, what is missing, what was read.
QString streaming_words(const stream::BrickLoaderStatus& hand, const DetailController::State& seen);
/// The same at length, for a tip.
QString streaming_tip(const stream::BrickLoaderStatus& hand, const DetailController::State& seen);
/// Why the hand waits, for where the eye is.
QString waiting_words(const stream::BrickLoaderStatus& hand);

}  // namespace palpate::viewer
