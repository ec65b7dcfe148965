// Names that the libraries give to choices and causes, in the person's language. Files keep the
// names themselves.
#pragma once

#include <QString>
#include <string>

#include "apps/viewer/model/layer_set.hpp"

class QComboBox;

namespace palpate::viewer {

/// Of transfer functions, colour maps, and causes of slow ticks; others as they are.
QString shown_name(const std::string& name);

QString shown_set(const std::string& name);

/// What felt_words() says, in the person's language.
QString felt_text(const LayersFelt& felt, const SharedLayers& layers);

/// Adds a choice that is shown so, with the name itself as its data.
void add_choice(QComboBox& box, const std::string& name);

}  // namespace palpate::viewer
