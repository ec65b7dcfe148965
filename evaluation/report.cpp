// Writes results as files.
#include "evaluation/report.hpp"

#include <cmath>
#include <nlohmann/json.hpp>

#include "palpate/io/output.hpp"

namespace palpate::evaluation {
namespace {

using Json = nlohmann::ordered_json;

Json json_from(const Table& table) {
    Json rows = Json::array();
    for (const auto& row : table.rows()) {
        Json& object = rows.emplace_back(Json::object());
        for (std::size_t i = 0; i < row.size(); ++i) {
            const auto* number = std::get_if<double>(&row[i]);
            if (!number) object[table.columns()[i]] = std::get<std::string>(row[i]);
            if (number && !std::isnan(*number)) object[table.columns()[i]] = *number;
        }
    }
    return rows;
}

}  // namespace

void write_files(const std::string& name, const Result& result,
                 const std::filesystem::path& folder) {
    io::write_file(folder / (name + ".csv"), csv_from(result.table));
    Json figures = Json::array(), claims = Json::array();
    for (const Figure& figure : result.figures) {
        const std::string file = name + (figure.suffix.empty() ? "" : "-" + figure.suffix) + ".svg";
        draw(figure, folder / file);
        figures.push_back({{"file", file}, {"caption", figure.caption}});
    }
    for (const Claim& claim : result.claims) {
        claims.push_back(
            {{"statement", claim.statement}, {"held", claim.held}, {"measured", claim.measured}});
    }
    const Json json{{"paragraph", result.paragraph},
                    {"summary", json_from(result.summary)},
                    {"figures", figures},
                    {"claims", claims}};
    io::write_file(folder / (name + ".json"), json.dump());
}

}  // namespace palpate::evaluation
