// Makes or reads the volumes of experiments.
#include "evaluation/subject.hpp"

#include <array>
#include <stdexcept>

#include "palpate/io/level.hpp"
#include "palpate/io/volume_file.hpp"
#include "palpate/scenes/volumes.hpp"

namespace palpate::evaluation {
namespace {

constexpr std::string_view synthetic_prefix = "synthetic:";

struct RealVolume {
    const char* name;
    const char* file;
    double isovalue;
};

constexpr std::array<RealVolume, 2> real_volumes{{
    {"lobster", "lobster.nrrd", 35},      // shell
    {"ct-head", "cthead_unc.nrrd", 500},  // skin
}};

}  // namespace

Subject synthetic(const std::string& specification, std::optional<double> isovalue,
                  std::optional<SampleType> type) {
    scenes::Scene scene = scenes::make_volume(specification, type);
    return {scene.name, Field(std::move(scene.volume)), isovalue.value_or(scene.isovalue),
            std::move(scene.exact)};
}

std::optional<Subject> real(const std::filesystem::path& data, std::string_view name) {
    for (const RealVolume& known : real_volumes) {
        if (name != known.name) continue;
        const auto path = data / known.file;
        if (data.empty() || !std::filesystem::exists(path)) return {};
        return Subject{known.name, Field(io::read_volume(path).volume), known.isovalue};
    }
    throw std::logic_error("no real volume is known as " + std::string(name));
}

Subject subject_from(const std::string& text) {
    const std::size_t at = text.rfind('@');
    const std::string where = text.substr(0, at);
    const std::string level = at == std::string::npos ? "" : text.substr(at + 1);
    const bool is_synthetic = where.starts_with(synthetic_prefix);
    if (level.empty() && !is_synthetic) {
        throw std::invalid_argument("volume " + text +
                                    ": which level is felt? Put it behind an @, as in " + text +
                                    "@300 or " + text + "@53%");
    }
    Subject subject = is_synthetic ? synthetic(where)
                                   : Subject{std::filesystem::path(where).stem().string(),
                                             Field(io::read_volume(where).volume)};
    if (!level.empty()) subject.isovalue = io::level_from_text(level, subject.field.volume());
    return subject;
}

}  // namespace palpate::evaluation
