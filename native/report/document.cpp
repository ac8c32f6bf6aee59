// SPDX-License-Identifier: Apache-2.0
#include "report/document.h"

#include <algorithm>
#include <cctype>

namespace fourdvt::report {
namespace {

constexpr const char* kStyle = R"(
:root{--ink:#1d2126;--soft:#68717c;--line:#dfe2e5;--paper:#f6f5f2;--card:#fff;--bar:#3f6f8f;--good:#13734c;--bad:#a8381c;
--c0:#0072b2;--c1:#d55e00;--c2:#008f68;--c3:#b0578d;--c4:#c98500;--c5:#3d9bd1;--c6:#6b7280;--c7:#7a4fbf;color-scheme:light dark}
@media(prefers-color-scheme:dark){:root{--ink:#e8eaec;--soft:#98a1ab;--line:#30363d;--paper:#14171a;--card:#1c2024;--bar:#6fa6c8;
--good:#5cc79a;--bad:#ee8a6b;--c0:#56aee6;--c1:#f08a4b;--c2:#3cc79c;--c3:#dd8fbe;--c4:#e8b23f;--c5:#9ad4f7;--c6:#a9b1bb;--c7:#b394ec}}
*{box-sizing:border-box}html{scroll-behavior:smooth}
body{margin:0;background:var(--paper);color:var(--ink);font:16px/1.5 system-ui,sans-serif}
.page{max-width:1040px;margin:0 auto;padding:clamp(20px,5vw,56px)}
h1{font-size:clamp(28px,5vw,44px);line-height:1.1;margin:0 0 8px;font-weight:650;letter-spacing:-.02em}
h2{font-size:22px;margin:0 0 12px;font-weight:640;letter-spacing:-.01em}h3{font-size:15px;margin:28px 0 10px;font-weight:620}
h2 a{color:inherit;text-decoration:none}h2 a:hover::after{content:" #";color:var(--soft)}
p{margin:0 0 10px;color:var(--soft);max-width:68ch}code{font:.9em ui-monospace,monospace;color:var(--ink);overflow-wrap:anywhere}
section{margin-top:56px;scroll-margin-top:20px}
nav ol{list-style:none;margin:28px 0 0;padding:0;display:flex;flex-wrap:wrap;gap:6px 8px}
nav a{display:block;padding:4px 10px;border:1px solid var(--line);border-radius:99px;background:var(--card);color:var(--soft);
font-size:13px;text-decoration:none}nav a:hover,nav a:focus-visible{color:var(--ink);border-color:var(--soft)}
.tiles{display:grid;grid-template-columns:repeat(auto-fit,minmax(160px,1fr));gap:1px;background:var(--card);
border:1px solid var(--line);border-radius:10px;overflow:hidden;margin:20px 0}
.tile{box-shadow:0 0 0 1px var(--line);padding:16px 18px}
.tile b{display:block;font-size:22px;font-weight:620;font-variant-numeric:tabular-nums}.tile span{color:var(--soft);font-size:13px;display:block}
.scroll{overflow-x:auto;border:1px solid var(--line);border-radius:10px;background:var(--card)}
table{border-collapse:collapse;width:100%;font-size:14px;font-variant-numeric:tabular-nums}
th,td{text-align:right;padding:8px 12px;border-bottom:1px solid var(--line);white-space:nowrap;vertical-align:top}
tbody tr:last-child>*{border-bottom:0}th{color:var(--soft);font-weight:500}thead th{font-size:13px;vertical-align:bottom}
th:first-child{text-align:left;position:sticky;left:0;background:var(--card)}tbody tr:hover>*{background:color-mix(in srgb,var(--line) 30%,var(--card))}
.words{text-align:left;white-space:normal;min-width:15ch}th.wrap{white-space:normal;min-width:14ch}
td.good{color:var(--good);font-weight:600}td.bad{color:var(--bad);font-weight:600}
.note{font-size:13px;margin:8px 0 0}
.plots{display:grid;grid-template-columns:repeat(auto-fit,minmax(min(100%,440px),1fr));gap:20px;margin-top:20px}
.plots figure{background:var(--card);border:1px solid var(--line);border-radius:10px;padding:16px}
.plots figcaption{font-size:15px;color:var(--ink);font-weight:620;margin:0 0 10px}.plots>figure>div{overflow-x:auto}
svg.bars{width:100%;max-width:720px;height:auto;display:block}svg.bars rect{fill:var(--bar)}
svg.bars text{font:13px system-ui,sans-serif;fill:var(--ink)}svg.bars .label{text-anchor:end;fill:var(--soft)}
header.with-poster{display:grid;grid-template-columns:1fr minmax(160px,240px);gap:32px;align-items:center}
footer{margin-top:48px;border-top:1px solid var(--line);padding-top:16px}
@media(max-width:640px){header.with-poster{grid-template-columns:1fr}}
svg.plot{width:100%;min-width:400px;height:auto;display:block}
.pictures{display:grid;grid-template-columns:repeat(auto-fit,minmax(min(100%,300px),1fr));gap:20px;margin-top:20px}
.pictures .wide{grid-column:1/-1}figure{margin:0}img{width:100%;height:auto;display:block;border-radius:8px;background:#8882}
figcaption{font-size:13px;color:var(--soft);margin-top:6px;max-width:80ch}
@media(min-width:1240px){.page{max-width:1280px;display:grid;grid-template-columns:190px minmax(0,1fr);column-gap:56px}
header,main,footer{grid-column:2}nav{grid-column:1;grid-row:1/3}nav ol{position:sticky;top:32px;display:block;margin:0}
nav a{border:0;background:none;padding:5px 0}}
@media print{nav{display:none}section{break-inside:avoid-page}.scroll{overflow:visible}}
)";

bool startsWith(const std::string& text, const char* start) { return text.rfind(start, 0) == 0; }
bool verdict(const std::string& cell) { return startsWith(cell, "✓") || startsWith(cell, "✗"); }

// True for figures, verdicts and marks of absence, as opposed to words.
bool figureCell(const std::string& cell) {
  if (cell.size() > 30) return false;
  if (cell.empty() || cell == "–") return true;
  size_t at = 0;
  for (const char* sign : {"−", "≤ ", "≥ ", "-", "+", "×", "≈ "})
    if (startsWith(cell, sign)) at = std::string(sign).size();
  return at < cell.size() && std::isdigit(static_cast<unsigned char>(cell[at]));
}

std::vector<bool> wordColumns(const Table& table) {
  std::vector<bool> words(table.columns.size(), false);
  for (const auto& row : table.rows)
    for (size_t c = 1; c < row.size() && c < words.size(); ++c)
      if (!figureCell(row[c])) words[c] = true;
  return words;
}

std::string bodyRow(const std::vector<std::string>& row, const std::vector<bool>& words) {
  std::string out = "<tr>";
  for (size_t c = 0; c < words.size(); ++c) {
    const std::string text = c < row.size() ? row[c] : "";
    if (c == 0 && !text.empty()) {
      out +=
          "<th scope=\"row\"" + std::string(text.size() > 36 ? " class=\"wrap\">" : ">") + htmlEscaped(text) + "</th>";
      continue;
    }
    std::string classes = words[c] ? "words" : "";
    if (verdict(text)) classes += startsWith(text, "✓") ? " good" : " bad";
    out += (classes.empty() ? "<td>" : "<td class=\"" + classes + "\">") + htmlEscaped(text) + "</td>";
  }
  return out + "</tr>\n";
}

// name: accessible name of the scrolling region.
std::string tableHtml(const Table& table, const std::string& name) {
  const std::vector<bool> words = wordColumns(table);
  std::string out = table.title.empty() ? "" : "<h3>" + htmlEscaped(table.title) + "</h3>\n";
  out += "<div class=\"scroll\" tabindex=\"0\" role=\"region\" aria-label=\"" + htmlEscaped(name) +
         "\"><table><thead><tr>";
  for (size_t c = 0; c < table.columns.size(); ++c)
    out += table.columns[c].empty() ? "<td></td>"
                                    : "<th scope=\"col\"" + std::string(words[c] ? " class=\"words\">" : ">") +
                                          htmlEscaped(table.columns[c]) + "</th>";
  out += "</tr></thead><tbody>\n";
  for (const auto& row : table.rows) out += bodyRow(row, words);
  out += "</tbody></table></div>\n";
  if (!table.note.empty()) out += "<p class=\"note\">" + htmlEscaped(table.note) + "</p>\n";
  return out;
}

// Paragraph with `code` for text in backticks; an unpaired backtick is kept.
std::string paragraph(const std::string& text) {
  std::string out = "<p>";
  size_t at = 0;
  while (at < text.size()) {
    const size_t open = text.find('`', at);
    const size_t close = open == std::string::npos ? open : text.find('`', open + 1);
    if (close == std::string::npos) break;
    out += htmlEscaped(text.substr(at, open - at)) + "<code>" + htmlEscaped(text.substr(open + 1, close - open - 1)) +
           "</code>";
    at = close + 1;
  }
  return out + htmlEscaped(text.substr(at)) + "</p>\n";
}

std::string paragraphs(const std::string& text) {
  std::string out;
  for (size_t at = 0; at < text.size();) {
    const size_t end = std::min(text.find("\n\n", at), text.size());
    if (end > at) out += paragraph(text.substr(at, end - at));
    at = end + 2;
  }
  return out;
}

std::string pictureHtml(const Picture& picture) {
  const bool wide = picture.width > 1000 || picture.width > 1.6 * picture.height;
  const std::string file = htmlEscaped(picture.file), caption = htmlEscaped(picture.caption);
  std::string size;
  if (picture.width > 0 && picture.height > 0)
    size = " width=\"" + std::to_string(picture.width) + "\" height=\"" + std::to_string(picture.height) + "\"";
  return std::string(wide ? "<figure class=\"wide\">" : "<figure>") + "<a href=\"" + file +
         "\"><img loading=\"lazy\" decoding=\"async\" src=\"" + file + "\"" + size + " alt=\"" + caption +
         "\"></a><figcaption>" + caption + "</figcaption></figure>\n";
}

// Title of the section, with the table's, or its number among several.
std::string tableName(const Section& section, size_t t) {
  const std::string& title = section.tables[t].title;
  const auto same = [&](const Table& other) { return other.title == title; };
  std::string out = section.title + (title.empty() ? "" : ": " + title);
  if (std::count_if(section.tables.begin(), section.tables.end(), same) > 1) out += ", table " + std::to_string(t + 1);
  return out;
}

std::string sectionHtml(const Section& section) {
  const std::string id = htmlEscaped(section.id);
  std::string out = "<section id=\"" + id + "\"><h2><a href=\"#" + id + "\">" + htmlEscaped(section.title) +
                    "</a></h2>\n" + paragraphs(section.text);
  if (!section.tiles.empty()) {
    out += "<div class=\"tiles\">\n";
    for (const Tile& tile : section.tiles)
      out += "<div class=\"tile\"><b>" + htmlEscaped(tile.value) + "</b><span>" + htmlEscaped(tile.meaning) +
             "</span></div>\n";
    out += "</div>\n";
  }
  for (BarChart chart : section.bar_charts) {
    if (chart.title.empty())
      chart.title = section.title;
    else
      out += "<h3>" + htmlEscaped(chart.title) + "</h3>\n";
    out += barsSvg(chart);
  }
  if (!section.plots.empty()) {
    out += "<div class=\"plots\">\n";
    for (const Plot& plot : section.plots)
      out += "<figure><figcaption>" + htmlEscaped(plot.title) +
             "</figcaption><div tabindex=\"0\" role=\"group\" aria-label=\"" +
             htmlEscaped(plot.title.empty() ? section.title : plot.title) + "\">" + plotSvg(plot) + "</div></figure>\n";
    out += "</div>\n";
  }
  for (size_t t = 0; t < section.tables.size(); ++t) out += tableHtml(section.tables[t], tableName(section, t));
  if (!section.pictures.empty()) {
    out += "<div class=\"pictures\">\n";
    for (const Picture& picture : section.pictures) out += pictureHtml(picture);
    out += "</div>\n";
  }
  return out + "</section>\n";
}

std::string headerHtml(const Document& document) {
  const std::string text = "<h1>" + htmlEscaped(document.title) + "</h1>\n" + paragraphs(document.subtitle);
  if (document.poster.file.empty()) return "<header>" + text + "</header>\n";
  return "<header class=\"with-poster\"><div>" + text + "</div>" + pictureHtml(document.poster) + "</header>\n";
}

}  // namespace

std::string documentHtml(const Document& document) {
  std::string out =
      "<!doctype html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><meta name=\"viewport\" "
      "content=\"width=device-width,initial-scale=1\"><title>" +
      htmlEscaped(document.title) + "</title><style>" + kStyle + "</style></head><body><div class=\"page\">\n" +
      headerHtml(document);
  if (document.sections.size() > 1) {
    out += "<nav aria-label=\"Contents\"><ol>\n";
    for (const Section& section : document.sections)
      out += "<li><a href=\"#" + htmlEscaped(section.id) + "\">" + htmlEscaped(section.title) + "</a></li>\n";
    out += "</ol></nav>\n";
  }
  out += "<main>\n";
  for (const Section& section : document.sections) out += sectionHtml(section);
  out += "</main>\n";
  if (!document.credit.empty()) out += "<footer>" + paragraphs(document.credit) + "</footer>\n";
  return out + "</div></body></html>\n";
}

}  // namespace fourdvt::report
