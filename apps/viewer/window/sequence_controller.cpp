// What the bar asks goes to the player; where the player is goes to the bar.
#include "apps/viewer/window/sequence_controller.hpp"

#include <utility>

#include "apps/viewer/panel/sequence_bar.hpp"
#include "apps/viewer/window/content.hpp"
#include "apps/viewer/window/messages.hpp"

namespace palpate::viewer {
namespace {

SequenceView sequence_view(const app::PlayView& play) {
    SequenceView view;
    view.begin = play.begin;
    view.end = play.end;
    view.frames = play.frames;
    view.time = play.time;
    view.speed = play.speed;
    view.loop = play.loop;
    view.loaded_from = play.loaded_from;
    view.loaded_to = play.loaded_to;
    view.live = play.live;
    return view;
}

}  // namespace

SequenceController::SequenceController(Content& content, SequenceBar& bar, Messages& messages)
    : content_(content), bar_(bar), messages_(messages) {
    const auto play = [this](auto&& action) {
        if (app::Player* player = content_.player()) {
            messages_.guarded([&] { action(*player); });
        }
    };
    connect(&bar, &SequenceBar::speed_asked, this,
            [play](double speed) { play([&](app::Player& player) { player.play(speed); }); });
    connect(&bar, &SequenceBar::moment_asked, this,
            [play](double time) { play([&](app::Player& player) { player.seek(time); }); });
    connect(&bar, &SequenceBar::loop_asked, this,
            [play](bool loop) { play([&](app::Player& player) { player.set_loop(loop); }); });
    connect(&content, &Content::closed, &bar, &QWidget::hide);
    connect(&content, &Content::run_changed, this, &SequenceController::show);
    bar.hide();
}

void SequenceController::show() {
    const app::Player* player = content_.player();
    bar_.setVisible(player != nullptr);
    if (player) bar_.set_view(sequence_view(player->view()));
}

void SequenceController::observe() {
    const app::Player* player = content_.player();
    if (!player) return;
    const app::PlayView play = player->view();
    bar_.set_view(sequence_view(play));
    const QString problem = QString::fromStdString(play.problem);
    if (problem != std::exchange(problem_, problem) && !problem.isEmpty()) {
        messages_.show_problem(problem);
    }
}

}  // namespace palpate::viewer
