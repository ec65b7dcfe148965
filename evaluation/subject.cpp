// Makes or reads the volumes of experiments.
#include "evaluation/subject.hpp"

#include <filesystem>
#include <stdexcept>
#include <string_view>

#include "palpate/io/level.hpp"
#include "palpate/io/volume_file.hpp"
#include "palpate/scenes/volumes.hpp"

namespace palpate::evaluation {
namespace {

constexpr std::string_view synthetic_prefix = "synthetic:";

Subject synthetic(const std::string& specification) {
    scenes::Scene scene = scenes::make_volume(specification);
    return {scene.name, linear_field(std::move(scene.volume)), scene.isovalue};
}

}  // namespace

Subject subject_from(const std::string& text) {
    std::size_t at = text.rfind('@');
    // An @ in a folder's name, or behind the password of an address, begins no level.
    const std::size_t host = text.find("://");
    const std::size_t path = host == text.npos ? 0 : text.find('/', host + 3);
    if (at < path || text.find('/', at) != text.npos) at = text.npos;
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
                                             linear_field(io::read_volume(where).volume)};
    if (!level.empty()) subject.isovalue = io::level_from_text(level, subject.field.volume());
    return subject;
}

}  // namespace palpate::evaluation
