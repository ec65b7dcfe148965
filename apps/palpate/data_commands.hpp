// Commands of people and scripts for the data of a live run: edits of a volume, playback of a
// sequence.
#pragma once

#include <functional>
#include <optional>
#include <stop_token>
#include <string>
#include <string_view>
#include <vector>

#include "palpate/run/run.hpp"

namespace palpate::app {

/// The words of one command. Whatever is not as expected throws std::invalid_argument with the
/// usage, which says how the command is written.
class CommandWords {
  public:
    CommandWords(std::vector<std::string> words, std::string usage)
        : words_(std::move(words)), usage_(std::move(usage)) {}
    /// The same words with another usage.
    CommandWords as(std::string usage) const { return {words_, std::move(usage)}; }

    /// Words with blanks between, or in quotes: save "my head.nrrd". Throws std::invalid_argument
    /// for a quote without an end.
    static std::vector<std::string> in(std::string_view line);
    const std::string& name() const { return words_.at(0); }
    std::size_t count() const { return words_.size(); }
    const std::string& operator[](std::size_t at) const { return words_[at]; }
    [[noreturn]] void refuse() const;
    /// Refuses fewer or more words, the name included.
    const CommandWords& expect(std::size_t least, std::size_t most) const;
    const CommandWords& expect(std::size_t exactly) const { return expect(exactly, exactly); }
    double number(std::size_t at) const;
    bool on_or_off() const;

  private:
    std::vector<std::string> words_;
    std::string usage_;
};

/// Changes the data, at the level `isovalue` of the field felt; returns a sentence for the person
/// who asked, or nothing. Throws std::invalid_argument for what the data cannot do,
/// io::OutputError, io::InputError, and what `progress` throws. Any thread.
using DataRequest = std::function<std::string(run::Data& data, const Field& field, double isovalue,
                                              const io::Progress& progress)>;

/// `carve|add|smooth|paint X,Y,Z[:X,Y,Z] RADIUS [VALUE]`, `fill I,J,K[:I,J,K] VALUE`, `undo`,
/// `redo`, `save FILE`, `play [SPEED]`, `pause`, `step [FRAMES]`, `seek SECONDS`, `loop on|off`.
/// Empty for other words. Throws io::OutputError for a file that could not be saved now.
DataRequest data_request(const CommandWords& words, const run::Data& now, const Volume& volume);

/// `brush KIND RADIUS [RATE [VALUE]]`, or `brush off`, which is nothing.
std::optional<run::HandBrush> brush_from(const CommandWords& words, const Volume& volume);
DataRequest set_brush(const std::optional<run::HandBrush>& brush);
DataRequest undo();
DataRequest redo();
DataRequest play(double speed);  ///< 0: pause
DataRequest step(int frames);    ///< on, or back if negative

}  // namespace palpate::app
