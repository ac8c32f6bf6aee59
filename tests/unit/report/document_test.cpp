// SPDX-License-Identifier: Apache-2.0
#include "report/document.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace fourdvt::report {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

std::string pointText(double x, double y) {
  char text[80];
  std::snprintf(text, sizeof text, "%.2f %.2f", x, y);
  return text;
}

bool contains(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

size_t count(const std::string& text, const std::string& part) {
  size_t n = 0;
  for (size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++n;
  return n;
}

TEST(Axis, LinearTicksAreMultiplesOfOneTwoFive) {
  const Axis a = makeAxis({0.853, 0.947}, false, false);
  const std::vector<double> wanted{0.84, 0.86, 0.88, 0.90, 0.92, 0.94, 0.96};
  ASSERT_EQ(a.ticks.size(), wanted.size());
  for (size_t i = 0; i < wanted.size(); ++i) EXPECT_NEAR(a.ticks[i], wanted[i], 1e-9);
  EXPECT_NEAR(a.low, 0.84, 1e-9);
  EXPECT_NEAR(a.high, 0.96, 1e-9);

  const Axis layers = makeAxis({1, 2, 3, 4, 5, 6}, false, true);
  EXPECT_EQ(layers.ticks, (std::vector<double>{1, 2, 3, 4, 5, 6}));

  const Axis negative = makeAxis({-130, 95}, false, false);
  EXPECT_DOUBLE_EQ(negative.low, -150);
  EXPECT_DOUBLE_EQ(negative.high, 100);
}

TEST(Axis, OneValueGetsRoom) {
  const Axis a = makeAxis({5}, false, false);
  EXPECT_LT(a.low, 5);
  EXPECT_GT(a.high, 5);
  EXPECT_TRUE(std::isfinite(a.share(5)));
  const Axis zero = makeAxis({0, 0}, false, false);
  EXPECT_LT(zero.low, zero.high);
  const Axis log = makeAxis({100}, true, true);
  EXPECT_LT(log.low, log.high);
  EXPECT_TRUE(std::isfinite(log.share(100)));
}

TEST(Axis, LogTicks) {
  EXPECT_EQ(makeAxis({256, 512, 1024, 2048}, true, true).ticks, (std::vector<double>{256, 512, 1024, 2048}));
  const Axis rates = makeAxis({0.7, 12}, true, false);
  const std::vector<double> wanted{0.5, 1, 2, 5, 10, 20};
  ASSERT_EQ(rates.ticks.size(), wanted.size());
  for (size_t i = 0; i < wanted.size(); ++i) EXPECT_NEAR(rates.ticks[i], wanted[i], 1e-9);
  EXPECT_NEAR(rates.share(std::sqrt(0.5 * 20)), 0.5, 1e-12);
}

TEST(PlotSvg, PointsLieWhereTheAxesSay) {
  const Plot plot{"t", "x", "y", false, false, {{"a", {{0, 0}, {5, 30}, {10, 100}}}}};
  const std::string svg = plotSvg(plot);  // axes 0..10 and 0..100
  const double x[] = {kPlotLeft, kPlotLeft + kPlotWidth / 2, kPlotLeft + kPlotWidth};
  const double y[] = {kPlotTop + kPlotHeight, kPlotTop + 0.7 * kPlotHeight, kPlotTop};
  EXPECT_TRUE(
      contains(svg, "d=\"M" + pointText(x[0], y[0]) + "L" + pointText(x[1], y[1]) + "L" + pointText(x[2], y[2])))
      << svg;
}

TEST(PlotSvg, LogarithmicPointsLieWhereTheAxesSay) {
  const Plot plot{"t", "x", "y", true, true, {{"a", {{256, 1}, {512, 10}, {2048, 100}}}}};
  const std::string svg = plotSvg(plot);  // 256..2048: three doublings
  EXPECT_TRUE(contains(svg, "d=\"M" + pointText(kPlotLeft, kPlotTop + kPlotHeight) + "L" +
                                pointText(kPlotLeft + kPlotWidth / 3, kPlotTop + kPlotHeight / 2) + "L" +
                                pointText(kPlotLeft + kPlotWidth, kPlotTop)))
      << svg;
}

TEST(PlotSvg, PointsThatAreNoneBreakTheCurve) {
  const Plot plot{"t", "x", "y", false, false, {{"a", {{0, 0}, {1, 1}, {2, kNaN}, {3, 1}, {4, 2}}}, {"b", {}}}};
  const std::string svg = plotSvg(plot);
  EXPECT_FALSE(contains(svg, "nan"));
  EXPECT_EQ(count(svg, "<path"), 1u);
  const size_t path = svg.find("d=\"");
  EXPECT_EQ(count(svg.substr(path, svg.find('"', path + 3) - path), "M"), 2u);
  const std::string negative = plotSvg({"t", "x", "y", true, false, {{"a", {{-1, 1}, {0, 2}, {10, 3}, {20, 4}}}}});
  EXPECT_FALSE(contains(negative, "nan"));
  EXPECT_FALSE(contains(negative, "inf"));
}

TEST(PlotSvg, EmptyPlotSaysSo) {
  for (const Plot& plot :
       {Plot{"t", "x", "y", false, false, {}}, Plot{"t", "x", "y", true, true, {{"a", {{1, kNaN}}}}}}) {
    const std::string svg = plotSvg(plot);
    EXPECT_TRUE(contains(svg, "not measured"));
    EXPECT_FALSE(contains(svg, "nan"));
    EXPECT_TRUE(contains(svg, "</svg>"));
  }
}

TEST(PlotSvg, CurvesDifferInColourAndDash) {
  Plot plot{"t", "x", "y", false, false, {}};
  for (int i = 0; i < 3; ++i) plot.curves.push_back({"curve" + std::to_string(i), {{0, i}, {1, i + 1}}});
  const std::string svg = plotSvg(plot);
  for (const char* style : {"var(--c0,", "var(--c1,", "var(--c2,"}) EXPECT_TRUE(contains(svg, style));
  EXPECT_EQ(count(svg, "stroke-dasharray:7 4"), 2u);  // curve 1 and its legend
  EXPECT_EQ(count(svg, "stroke-dasharray:2 3"), 2u);
  for (int i = 0; i < 3; ++i) EXPECT_TRUE(contains(svg, ">curve" + std::to_string(i) + "</text>"));
}

TEST(BarsSvg, LengthsAreRelativeToTheLargest) {
  const std::string svg = barsSvg({"sizes", {{"video", "4 kB", 4000}, {"mesh <b>", "1 kB", 1000}, {"none", "0 B", 0}}});
  EXPECT_TRUE(contains(svg, "width=\"400.0\""));  // 640 minus the label's and the value's width
  EXPECT_TRUE(contains(svg, "width=\"100.0\""));
  EXPECT_TRUE(contains(svg, "width=\"1.0\""));  // minimum width
  EXPECT_TRUE(contains(svg, ">mesh &lt;b&gt;</text>"));
  EXPECT_TRUE(contains(barsSvg({"empty", {}}), "</svg>"));
}

TEST(DocumentHtml, PosterBarsAndCreditAreShown) {
  Document document{"Title", "Sub", {}};
  EXPECT_FALSE(contains(documentHtml(document), "<footer>"));
  EXPECT_TRUE(contains(documentHtml(document), "<header><h1>"));
  document.poster = {"poster.webp", "the actor"};
  document.credit = "Filmed by nobody.";
  Section section{"sizes", "Sizes", "", {}, {}, {}, {}};
  section.bar_charts = {{"", {{"video", "4 kB", 4000}}}};
  document.sections = {section};
  const std::string html = documentHtml(document);
  EXPECT_TRUE(contains(html, "src=\"poster.webp\""));
  EXPECT_TRUE(contains(html, "<footer><p>Filmed by nobody.</p>"));
  EXPECT_EQ(count(html, "<svg class=\"bars\""), 1u);
}

TEST(DocumentHtml, ScrollingRegionsHaveNamesOfTheirOwnAndHeadersText) {
  const Table bare{"", "", {"", "ms"}, {{"drawing", "1"}, {"", "2"}}}, named{"Sizes", "", {"file", "kB"}, {{"a", "1"}}};
  Document document;
  document.sections.push_back(
      {"speed", "Speed", "", {bare, bare, named}, {{"", "s", "ms", false, false, {}}}, {}, {}, {}});
  document.sections.push_back({"memory", "Memory", "", {bare}, {}, {}, {}, {{"", {{"all", "1", 1}}}}});
  const std::string html = documentHtml(document);
  for (const char* name : {"Speed, table 1", "Speed, table 2", "Speed: Sizes", "Memory"})
    EXPECT_EQ(count(html, std::string("role=\"region\" aria-label=\"") + name + "\""), 1u) << name;
  EXPECT_EQ(count(html, "></th>"), 0u);
  EXPECT_EQ(count(html, "<figcaption></figcaption><div tabindex=\"0\" role=\"group\" aria-label=\"Speed\">"), 1u);
  EXPECT_TRUE(contains(html, "role=\"img\" aria-label=\"Memory\"")) << "the bars have the section's name";
}

TEST(Escaping, NothingOfTheTextBecomesMarkup) {
  const std::string evil = "<b>\"a\" & 'b'</b>";
  EXPECT_EQ(htmlEscaped(evil), "&lt;b&gt;&quot;a&quot; &amp; &#39;b&#39;&lt;/b&gt;");
  Document document{evil, evil, {}};
  Section section{evil, evil, evil + " `" + evil + "`", {}, {}, {}, {}};
  section.tables.push_back({evil, evil, {evil, evil}, {{evil, evil}}});
  section.plots.push_back({evil, evil, evil, false, false, {{evil, {{0, 1}, {1, 2}}}}});
  section.pictures.push_back({evil, evil, 10, 10});
  section.tiles.push_back({evil, evil});
  document.sections = {section, section};
  const std::string html = documentHtml(document);
  EXPECT_FALSE(contains(html, "<b>\""));
  EXPECT_FALSE(contains(html, "\"a\""));
  EXPECT_FALSE(contains(html, "& 'b'"));
  EXPECT_FALSE(contains(html, "<script"));
}

TEST(DocumentHtml, HoldsEverySectionAndPicture) {
  Document document{"Title", "Sub", {}};
  for (const char* id : {"one", "two", "three"}) {
    Section section{id, std::string("Section ") + id, "First.\n\nSecond.", {}, {}, {}, {}};
    section.pictures.push_back({std::string("pictures/") + id + ".jpg", std::string("caption ") + id, 640, 480});
    document.sections.push_back(section);
  }
  document.sections[1].tables.push_back({"A table", "A note", {"", "x", "words"}, {{"row", "1.5", "many"}, {"short"}}});
  const std::string html = documentHtml(document);
  for (const std::string id : {"one", "two", "three"}) {
    EXPECT_TRUE(contains(html, "<section id=\"" + id + "\">"));
    EXPECT_TRUE(contains(html, "<li><a href=\"#" + id + "\">Section " + id + "</a>"));
    EXPECT_TRUE(contains(html, "<img loading=\"lazy\" decoding=\"async\" src=\"pictures/" + id +
                                   ".jpg\" width=\"640\" height=\"480\" alt=\"caption " + id + "\">"));
  }
  EXPECT_EQ(count(html, "<p>First.</p>"), 3u);
  EXPECT_EQ(count(html, "<p>Second.</p>"), 3u);
  EXPECT_TRUE(contains(html, "<td>1.5</td><td class=\"words\">many</td>"));
  EXPECT_TRUE(contains(html, "A note"));
  EXPECT_EQ(count(html, "<tr>"), count(html, "</tr>"));
}

}  // namespace
}  // namespace fourdvt::report
