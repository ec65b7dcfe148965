// Writes results as files: Markdown beside the tables and figures, and one HTML page.
#include "evaluation/report.hpp"

#include <fmt/format.h>

#include <cstdint>
#include <fstream>
#include <iterator>

#include "evaluation/html.hpp"
#include "palpate/io/output.hpp"

namespace palpate::evaluation {
namespace {

namespace fs = std::filesystem;

std::string file_name(const Report& report, const std::string& suffix) {
    return report.experiment.name + (suffix.empty() ? "" : "-" + suffix);
}

/// Calls f(file name, caption) for all figures, as SVG, and pictures.
template <class F>
void for_images(const Report& report, F&& f) {
    for (const Figure& figure : report.result.figures) {
        f(file_name(report, figure.suffix) + ".svg", figure.caption);
    }
    for (const Picture& picture : report.result.pictures) {
        f(file_name(report, picture.suffix) + ".png", picture.caption);
    }
}

/// `no`: how a claim that does not hold is marked.
Table claims_of(const Result& result, const char* no) {
    Table table;
    for (const Claim& claim : result.claims) {
        table.add({{"claim", claim.statement},
                   {"holds", claim.held ? "yes" : no},
                   {"measured", claim.measured}});
    }
    return table;
}

/// Empty for an empty table.
std::string markdown_from(const Table& table) {
    if (table.rows().empty()) return {};
    std::string text, rule;
    const auto cell = [&](const std::string& content) { text += "| " + content + " "; };
    for (const std::string& column : table.columns()) {
        cell(column);
        rule += "|---";
    }
    text += "|\n" + rule + "|\n";
    for (const auto& row : table.rows()) {
        for (const Cell& value : row) {
            const double* const number = std::get_if<double>(&value);
            cell(number ? fmt::format("{:.4g}", *number) : std::get<std::string>(value));
        }
        text += "|\n";
    }
    return text + "\n";
}

std::string markdown_from(const Report& report) {
    std::string text = fmt::format("# {}: {}\n\n{}\n\n", report.experiment.name,
                                   report.experiment.title, report.result.paragraph);
    text += markdown_from(report.result.summary);
    for_images(report, [&](const std::string& file, const std::string& caption) {
        text += fmt::format("![{0}]({1})\n\n{0}\n\n", caption, file);
    });
    return text + markdown_from(claims_of(report.result, "**no**")) +
           fmt::format("All numbers: [{0}.csv]({0}.csv). {1}.\n", report.experiment.name,
                       report.circumstances);
}

std::string base64(const std::string& bytes) {
    static constexpr char digits[] =
        "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::string text;
    for (std::size_t i = 0; i < bytes.size(); i += 3) {
        std::uint32_t three = 0;
        for (std::size_t k = 0; k < 3; ++k) {
            three =
                three << 8 | (i + k < bytes.size() ? static_cast<unsigned char>(bytes[i + k]) : 0U);
        }
        for (std::size_t k = 0; k < 4; ++k) {
            text += i + k > bytes.size() ? '=' : digits[three >> (18 - 6 * k) & 63U];
        }
    }
    return text;
}

/// The file as a data URL.
std::string embedded(const fs::path& file) {
    std::ifstream in(file, std::ios::binary);
    const std::string bytes{std::istreambuf_iterator<char>(in), {}};
    if (!in || bytes.empty()) throw io::OutputError(file.string() + ": cannot be read");
    return fmt::format("data:image/{};base64,{}", file.extension() == ".svg" ? "svg+xml" : "png",
                       base64(bytes));
}

std::string section(const Report& report, const fs::path& folder) {
    std::string html =
        fmt::format("<h2 id=\"{0}\">{0}: {1}</h2>\n<p>{2}</p>\n", report.experiment.name,
                    html_text(report.experiment.title), html_text(report.result.paragraph));
    html += html_from(report.result.summary);
    for_images(report, [&](const std::string& file, const std::string& caption) {
        html += fmt::format(
            "<figure><img src=\"{0}\" alt=\"{1}\"><figcaption>{1}</figcaption></figure>\n",
            embedded(folder / file), html_text(caption));
    });
    return html + html_from(claims_of(report.result, "NO")) +
           fmt::format(
               "<details><summary>All numbers ({} rows)</summary>\n{}</details>\n"
               "<p class=c>{}.</p>\n",
               report.result.table.rows().size(), html_from(report.result.table),
               html_text(report.circumstances));
}

}  // namespace

void write_files(const Report& report, const fs::path& folder) {
    const auto path = [&](const std::string& suffix, const char* extension) {
        return folder / (file_name(report, suffix) + extension);
    };
    io::write_file(path("", ".csv"), csv_from(report.result.table));
    for (const Figure& figure : report.result.figures) {
        draw(figure, path(figure.suffix, ".svg"));
        draw(figure, path(figure.suffix, ".png"));
    }
    for (const Picture& picture : report.result.pictures) {
        io::write_file(path(picture.suffix, ".png"), picture.png);
    }
    io::write_file(path("", ".md"), markdown_from(report));
}

void write_html(const std::vector<Report>& reports, const fs::path& folder, const fs::path& page) {
    std::string html =
        "<!DOCTYPE html>\n<html lang=\"en\"><meta charset=\"utf-8\">"
        "<title>Palpate: the evidence</title>\n<style>"
        "body{font-family:sans-serif;max-width:64em;margin:2em auto;padding:0 1em;line-height:1.5}"
        "img{max-width:100%}figure{margin:1em 0}figcaption,.c{color:#444;font-size:90%}"
        "table{border-collapse:collapse;font-size:85%}td,th{border:1px solid #ccc;padding:.2em "
        ".5em;text-align:left}td.n{text-align:right}details{overflow-x:auto}</style>\n"
        "<h1>Palpate: the evidence</h1>\n<ul>\n";
    for (const Report& report : reports) {
        std::size_t held = 0;
        for (const Claim& claim : report.result.claims) held += claim.held;
        html += fmt::format("<li><a href=\"#{0}\">{0}</a>: {1} ({2} of {3} claims hold)</li>\n",
                            report.experiment.name, html_text(report.experiment.title), held,
                            report.result.claims.size());
    }
    html += "</ul>\n";
    for (const Report& report : reports) html += section(report, folder);
    io::write_file(page, html + "</html>\n");
}

}  // namespace palpate::evaluation
