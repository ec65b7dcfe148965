// Reads and carries out commands for edits and sequences.
#include "apps/palpate/data_commands.hpp"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "io/number.hpp"
#include "palpate/io/level.hpp"

namespace palpate::app {
namespace {

double number(const std::string& word, const std::string& meant) {
    if (word == "inf") return std::numeric_limits<double>::infinity();
    const auto value = io::number_from<double>(word);
    if (!value) wrong_words(meant);
    return *value;
}

Vec3 point(const std::string& word, const std::string& meant) {
    Vec3 p;
    std::size_t begin = 0;
    for (int a = 0; a < 3; ++a) {
        const std::size_t end = a < 2 ? word.find(',', begin) : word.size();
        if (end == std::string::npos) wrong_words(meant);
        p[a] = number(word.substr(begin, end - begin), meant);
        begin = end + 1;
    }
    return p;
}

/// "A" or "A:B".
std::array<Vec3, 2> two_points(const std::string& word, const std::string& meant) {
    const std::size_t colon = word.find(':');
    const Vec3 first = point(word.substr(0, colon), meant);
    return {first, colon == std::string::npos ? first : point(word.substr(colon + 1), meant)};
}

DataRequest brush_request(const std::vector<std::string>& words, const Volume& volume) {
    const std::string meant = "brush KIND RADIUS [RATE [VALUE]], or brush off,";
    if (words.size() == 2 && words[1] == "off") return ask::SetBrush{};
    if (words.size() < 3 || words.size() > 5) wrong_words(meant);
    run::HandBrush brush;
    brush.kind = brush_kind_from(words[1]);
    brush.radius = number(words[2], meant);
    if (words.size() > 3) brush.rate = number(words[3], meant);
    if (words.size() > 4) brush.value = io::level_from_text(words[4], volume);
    run::check(brush);
    return ask::SetBrush{brush};
}

DataRequest touch_request(const std::vector<std::string>& words, const Volume& volume) {
    const std::string meant = words[0] + " X,Y,Z[:X,Y,Z] RADIUS [VALUE]";
    if (words.size() < 3 || words.size() > 4) wrong_words(meant);
    ask::Touch touch;
    touch.brush.kind = brush_kind_from(words[0]);
    touch.brush.radius = number(words[2], meant);
    if (words.size() > 3) touch.brush.value = io::level_from_text(words[3], volume);
    run::check(touch.brush);
    const auto [from, to] = two_points(words[1], meant);
    touch.from = from;
    touch.to = to;
    return touch;
}

DataRequest fill_request(const std::vector<std::string>& words, const Volume& volume) {
    const std::string meant = "fill I,J,K[:I,J,K] VALUE";
    if (words.size() != 3) wrong_words(meant);
    const auto [low, high] = two_points(words[1], meant);
    const double most = std::max(low.cwiseAbs().maxCoeff(), high.cwiseAbs().maxCoeff());
    if (!(most <= 1 << 20)) wrong_words(meant);
    const SampleBox box{low.cwiseMin(high).cast<int>(), low.cwiseMax(high).cast<int>()};
    return ask::Fill{{box, io::level_from_text(words[2], volume)}};
}

DataRequest play_request(const std::vector<std::string>& words) {
    if (words.size() > 2) wrong_words("play [SPEED]");
    const double speed = words.size() > 1 ? number(words[1], "play [SPEED]") : 1;
    if (!(std::abs(speed) <= 1000)) wrong_words("play [SPEED], at most 1000,");
    return ask::Play{speed};
}

struct CarryOut {
    run::Data& data;
    const Field& field;
    double isovalue;

    std::string operator()(const ask::SetBrush& asked) const {
        data.editor().set_brush(asked.brush);
        return asked.brush ? fmt::format("brush: {}, {:g} mm", name_of(asked.brush->kind),
                                         asked.brush->radius)
                           : "brush: off";
    }
    std::string operator()(const ask::Touch& asked) const {
        if (!std::isfinite(isovalue)) throw std::invalid_argument("no level is felt to shape");
        Brush brush = brush_for(asked.brush.kind, field, isovalue, asked.brush.radius);
        if (asked.brush.value) brush.value = *asked.brush.value;
        data.editor().apply(edit::Stroke{brush, asked.from, asked.to});
        return {};
    }
    std::string operator()(const ask::Fill& asked) const {
        data.editor().apply(asked.fill);
        return {};
    }
    std::string operator()(const ask::Undo&) const {
        return data.editor().undo() ? "" : "there is nothing to undo";
    }
    std::string operator()(const ask::Redo&) const {
        return data.editor().redo() ? "" : "there is nothing to redo";
    }
    std::string operator()(const ask::Save& asked) const { return data.save(asked.path, {}); }
    std::string operator()(const ask::Play& asked) const {
        data.player().play(asked.speed);
        return {};
    }
    std::string operator()(const ask::Step& asked) const {
        data.player().step(asked.frames);
        return {};
    }
    std::string operator()(const ask::Seek& asked) const {
        data.player().seek(asked.time);
        return {};
    }
    std::string operator()(const ask::Loop& asked) const {
        data.player().set_loop(asked.on);
        return {};
    }
};

}  // namespace

void wrong_words(const std::string& meant) {
    throw std::invalid_argument(meant + " is meant to be there");
}

std::optional<DataRequest> data_request(const std::vector<std::string>& words,
                                        const Volume& volume) {
    const std::string& name = words.at(0);
    const bool alone = words.size() == 1;
    if (name == "brush") return brush_request(words, volume);
    if (name == "carve" || name == "add" || name == "smooth" || name == "paint") {
        return touch_request(words, volume);
    }
    if (name == "fill") return fill_request(words, volume);
    if (name == "undo" && alone) return ask::Undo{};
    if (name == "redo" && alone) return ask::Redo{};
    if (name == "save") {
        if (words.size() != 2) wrong_words("save FILE");
        run::check_volume_name(words[1], volume.geometry());
        return ask::Save{words[1]};
    }
    if (name == "play") return play_request(words);
    if (name == "pause" && alone) return ask::Play{0};
    if (name == "step") {
        const double frames = alone ? 1 : number(words[1], "step [FRAMES]");
        if (words.size() > 2 || !(std::abs(frames) <= 1e6)) wrong_words("step [FRAMES]");
        return ask::Step{static_cast<int>(frames)};
    }
    if (name == "seek") {
        if (words.size() != 2) wrong_words("seek SECONDS");
        const double time = number(words[1], "seek SECONDS");
        if (!std::isfinite(time)) wrong_words("seek SECONDS");
        return ask::Seek{time};
    }
    if (name == "loop") {
        if (words.size() != 2 || (words[1] != "on" && words[1] != "off"))
            wrong_words("loop on|off");
        return ask::Loop{words[1] == "on"};
    }
    return std::nullopt;
}

std::string carry_out(const DataRequest& request, run::Data& data, const Field& field,
                      double isovalue) {
    return std::visit(CarryOut{data, field, isovalue}, request);
}

}  // namespace palpate::app
