#include "signal/chart.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/text.hpp"

namespace evodevo {
namespace {

constexpr double side = 320, left = 60, top = 40, gap = 40;  ///< of a panel, in pixels

/// The least and the greatest score in all panels, with a spare.
struct Span {
  double low, high;

  double place(double score) const { return (score - low) / (high - low) * side; }
};

Span span_of(const Signal& signal) {
  double low = 0, high = 0;
  for (const auto& [population, families] : signal.families)
    for (const Family& family : families)
      for (const double parents : family.parents) {
        low = std::min({low, parents, family.children});
        high = std::max({high, parents, family.children});
      }
  const double spare = high > low ? 0.05 * (high - low) : 1;
  return {low - spare, high + spare};
}

/// Returns the distance of marks on an axis: 1, 2 or 5 times a power of ten, so that there are at most six.
double distance_of_marks(const Span& span) {
  const double least = (span.high - span.low) / 6, power = std::pow(10, std::floor(std::log10(least)));
  for (const double factor : {1.0, 2.0, 5.0})
    if (factor * power >= least) return factor * power;
  return 10 * power;
}

std::string axes(const Span& span) {
  std::string text = fmt::format("<rect width=\"{0:.0f}\" height=\"{0:.0f}\" fill=\"none\" stroke=\"#999\"/>\n", side);
  const double step = distance_of_marks(span);
  for (double mark = step * std::ceil(span.low / step); mark <= span.high; mark += step) {
    const double at = span.place(mark);
    const std::string label = short_number(std::abs(mark) < step / 2 ? 0 : mark);
    text += fmt::format("<text x=\"{:.1f}\" y=\"{:.0f}\" text-anchor=\"middle\">{}</text>\n", at, side + 16, label);
    text += fmt::format("<text x=\"-6\" y=\"{:.1f}\" text-anchor=\"end\">{}</text>\n", side - at + 4, label);
  }
  return text;
}

/// Returns the line of the regression through the mean of the points, cut at the borders of the panel.
std::string line(const Span& span, const std::vector<Family>& families, double slope) {
  double x = 0, y = 0, weight = 0;
  for (const Family& family : families)
    for (const double parents : family.parents) {
      x += family.weight * parents;
      y += family.weight * family.children;
      weight += family.weight;
    }
  x /= weight;
  y /= weight;
  const auto end = [&](double border) {
    const double height = std::clamp(y + slope * (border - x), span.low, span.high);
    return std::pair{span.place(slope == 0 ? border : x + (height - y) / slope), side - span.place(height)};
  };
  const auto [x1, y1] = end(span.low);
  const auto [x2, y2] = end(span.high);
  return fmt::format(
      "<line x1=\"{:.1f}\" y1=\"{:.1f}\" x2=\"{:.1f}\" y2=\"{:.1f}\" stroke=\"#d55e00\" stroke-width=\"2\"/>\n", x1, y1,
      x2, y2);
}

}  // namespace

std::string signal_chart(const Signal& signal, const Objective& objective) {
  const Span span = span_of(signal);
  const auto panels = static_cast<double>(std::max<std::size_t>(1, signal.families.size()));
  const double width = left + panels * (side + gap), height = top + side + 60;
  std::string text = fmt::format(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{0:.0f}\" height=\"{1:.0f}\" viewBox=\"0 0 {0:.0f} {1:.0f}\" "
      "font-family=\"sans-serif\" font-size=\"12\">\n<rect width=\"{0:.0f}\" height=\"{1:.0f}\" fill=\"#fff\"/>\n",
      width, height);
  std::string title = objective.name + (objective.unit == "1" ? "" : " (" + objective.unit + ")");
  for (const auto& [character, escaped] : {std::pair{"&", "&amp;"}, {"<", "&lt;"}, {">", "&gt;"}})
    replace_all(title, character, escaped);
  double x = left;
  for (const auto& [population, families] : signal.families) {
    text += fmt::format("<g transform=\"translate({:.0f} {:.0f})\">\n", x, top);
    text += fmt::format("<text x=\"0\" y=\"-14\" font-weight=\"bold\">{} population</text>\n", population);
    text += axes(span);
    text += fmt::format(
        "<line x1=\"0\" y1=\"{0:.0f}\" x2=\"{0:.0f}\" y2=\"0\" stroke=\"#bbb\" stroke-dasharray=\"4\"/>\n", side);
    for (const Family& family : families)
      for (const double parents : family.parents)
        text += fmt::format("<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"3\" fill=\"#0072b2\" fill-opacity=\"0.4\"/>\n",
                            span.place(parents), side - span.place(family.children));
    for (const SignalNumber& number : signal.numbers)
      if (number.population == population && number.quantity == "heritability" && number.of == "all children" &&
          number.scale == "value")
        text += line(span, families, number.value);
    text += fmt::format("<text x=\"{:.0f}\" y=\"{:.0f}\" text-anchor=\"middle\">parents: {}</text>\n", side / 2,
                        side + 36, title);
    text += "</g>\n";
    x += side + gap;
  }
  text += fmt::format(
      "<text transform=\"translate(14 {:.0f}) rotate(-90)\" text-anchor=\"middle\">mean of the children</text>\n",
      top + side / 2);
  return text + "</svg>\n";
}

}  // namespace evodevo
