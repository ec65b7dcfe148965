// A panel with two sets of layers to choose from.
#pragma once

#include <QComboBox>

#include <vector>

#include "apps/viewer/window/layers_controls.hpp"
#include "palpate/io/layers_file.hpp"
#include "tests/viewer/panel/panel_fixture.hpp"

namespace palpate::viewer {

class LayersFixture : public PanelFixture {
  protected:
    LayersFixture() {
        set();
        for (const char* name : {"ct-soft-tissue-and-bone", "ct-needle"}) {
            const io::LayersFile file = io::layers_named(name);
            choices.push_back({std::make_shared<const Layers>(file.layers),
                               QString::fromStdString(file.about),
                               {},
                               true});
        }
        choices.back().note = "These are for CT";
        panel.layers_controls().set_choices(choices);
    }
    /// As by the keys of someone who has tabbed there.
    void choose(int row) {
        auto* box = find<QComboBox>("layers");
        box->setFocus();
        // Not for ever: what is refused is shown as before.
        for (int i = box->count(); i > 0 && box->currentIndex() != row; --i) {
            QTest::keyClick(box, box->currentIndex() < row ? Qt::Key_Down : Qt::Key_Up);
        }
        settle();
    }
    /// Only a check box's own words take clicks, not all of its row.
    void tick(const char* name) {
        auto* box = find<QWidget>(name);
        QTest::mouseClick(box, Qt::LeftButton, {}, QPoint(8, box->height() / 2));
        settle();
    }
    SharedLayers asked() {
        const auto all = of<command::UseLayers>();
        return all.empty() ? nullptr : all.back().layers;
    }
    const Layer& layer(std::size_t number) { return asked()->layers.at(number); }

    std::vector<LayersChoice> choices;
};

}  // namespace palpate::viewer
