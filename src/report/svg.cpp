// The diagrams, with logarithmic axes.
#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "core/format.h"
#include "report/write.h"

namespace glint::report {

namespace {

constexpr double kWidth = 860, kHeight = 460;                         // higher where the legend is
constexpr double kLeft = 80, kRight = 600, kTop = 40, kBottom = 400;  // of the axes
constexpr double kLegendLeft = 620, kLegendStep = 17;

// Told apart with most kinds of colour blindness: Okabe, Ito, "Color Universal Design", 2008.
constexpr std::array<const char*, 7> kColors{"#0072b2", "#d55e00", "#009e73", "#cc79a7",
                                             "#e69f00", "#56b4e9", "#555555"};

struct Point {
    double x = 0, y = 0;
    std::string mark, tip;  // mark: a letter in place of the dot
};

struct Series {
    std::string label;
    std::vector<Point> points;
    bool line = true;
};

std::string text(double x, double y, const char* anchor, const std::string& content,
                 const std::string& more = "") {
    return format("<text x=\"%.1f\" y=\"%.1f\" text-anchor=\"%s\" ", x, y, anchor) + more + ">" +
           escapeMarkup(content) + "</text>\n";
}

std::string line(double x0, double y0, double x1, double y1, const char* style) {
    return format("<line x1=\"%.1f\" y1=\"%.1f\" x2=\"%.1f\" y2=\"%.1f\" %s/>\n", x0, y0, x1, y1, style);
}

std::string letterStyle(const char* color) {
    return std::string("font-weight=\"bold\" fill=\"") + color + "\"";
}

// A range of positive numbers on a logarithmic axis, with room at both ends.
class LogAxis {
  public:
    LogAxis(double from, double to) : from_(from), to_(to) {}

    void include(double value) {
        const double l = std::log10(value);
        low_ = std::min(low_, l);
        high_ = std::max(high_, l);
    }
    void addRoom() {
        const double room = std::max(0.08 * (high_ - low_), 0.15);
        low_ -= room;
        high_ += room;
    }
    double at(double value) const {
        return from_ + (std::log10(value) - low_) / (high_ - low_) * (to_ - from_);
    }
    // 1, and 2 and 5 if there are few decades.
    std::vector<double> ticks() const {
        std::vector<double> values;
        const bool few = high_ - low_ < 2.5;
        for (int decade = static_cast<int>(std::floor(low_)); decade <= static_cast<int>(high_) + 1;
             ++decade) {
            for (const double digit : {1.0, 2.0, 5.0}) {
                const double l = decade + std::log10(digit);
                if ((few || digit == 1) && l >= low_ && l <= high_)
                    values.push_back(digit * std::pow(10.0, decade));
            }
        }
        return values;
    }

  private:
    double from_, to_;
    double low_ = 1e300, high_ = -1e300;
};

class Drawing {
  public:
    Drawing(std::string title, std::string yLabel) : title_(std::move(title)), yLabel_(std::move(yLabel)) {}

    void add(Series series) {
        std::erase_if(series.points, [](const Point& p) { return !(p.x > 0) || !(p.y > 0); });
        if (series.points.empty()) return;
        include(series.points);
        series_.push_back(std::move(series));
    }
    // The Pareto front, drawn below the other curves.
    void setFront(std::vector<Point> front) {
        include(front);
        front_ = std::move(front);
    }

    std::string draw() {
        if (series_.empty()) return "";
        x_.addRoom();
        y_.addRoom();
        const double height =
            std::max(kHeight, kTop + kLegendStep * (static_cast<double>(series_.size()) + 2));
        std::string out = format(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"%g\" height=\"%g\" viewBox=\"0 0 %g %g\" "
            "font-family=\"sans-serif\" font-size=\"12\">\n"
            "<rect width=\"100%%\" height=\"100%%\" fill=\"white\"/>\n",
            kWidth, height, kWidth, height);
        out += axes();
        double legend = kTop + 8;
        if (front_.size() > 1) {
            out += path(front_, "stroke=\"#bbbbbb\" stroke-width=\"7\" stroke-opacity=\"0.6\"");
            out += line(kLegendLeft, legend - 4, kLegendLeft + 18, legend - 4,
                        "stroke=\"#bbbbbb\" stroke-width=\"7\"");
            out += text(kLegendLeft + 26, legend, "start", "nothing is faster and more exact");
            legend += kLegendStep;
        }
        for (size_t i = 0; i < series_.size(); ++i, legend += kLegendStep) out += drawSeries(i, legend);
        return out + "</svg>\n";
    }

  private:
    void include(const std::vector<Point>& points) {
        for (const Point& p : points) {
            x_.include(p.x);
            y_.include(p.y);
        }
    }

    std::string axes() const {
        const char* grid = "stroke=\"#e4e4e4\"";
        std::string out = text(kLeft, 22, "start", title_, "font-size=\"15\" font-weight=\"bold\"");
        for (const double v : x_.ticks()) {
            out += line(x_.at(v), kTop, x_.at(v), kBottom, grid);
            out += text(x_.at(v), kBottom + 16, "middle", shortNumber(v));
        }
        for (const double v : y_.ticks()) {
            out += line(kLeft, y_.at(v), kRight, y_.at(v), grid);
            out += text(kLeft - 6, y_.at(v) + 4, "end", shortNumber(v));
        }
        out += "<path d=\"M80 40V400H600\" fill=\"none\" stroke=\"black\"/>\n";
        out +=
            text((kLeft + kRight) / 2, kBottom + 40, "middle", "seconds for the image (median, wall clock)");
        return out + text(0, 0, "middle", yLabel_, "transform=\"translate(20 220) rotate(-90)\"");
    }

    std::string path(const std::vector<Point>& points, const std::string& style) const {
        std::string d;
        for (const Point& p : points)
            d += format("%c%.1f %.1f", d.empty() ? 'M' : 'L', x_.at(p.x), y_.at(p.y));
        return "<path d=\"" + d + "\" fill=\"none\" stroke-linejoin=\"round\" " + style + "/>\n";
    }

    // Letters keep clear of the marks before them: the nearest free place on a spiral, within the axes.
    std::string mark(double x, double y, const std::string& letter, const char* color) {
        const double x0 = x, y0 = y;
        const auto taken = [&] {
            return std::any_of(marks_.begin(), marks_.end(), [&](const auto& m) {
                return std::abs(m.first - x) < 11 && std::abs(m.second - y) < 12;
            });
        };
        for (int step = 1; step < 400 && !letter.empty() && taken(); ++step) {
            const double angle = 0.7 * step, radius = 3 * std::sqrt(step) + 6;
            x = std::clamp(x0 + radius * std::cos(angle), kLeft + 6, kRight - 6);
            y = std::clamp(y0 + radius * std::sin(angle), kTop + 8, kBottom - 8);
        }
        marks_.emplace_back(x, y);
        return letter.empty() ? format("<circle cx=\"%.1f\" cy=\"%.1f\" r=\"4\" fill=\"%s\"/>\n", x, y, color)
                              : text(x, y + 4, "middle", letter, letterStyle(color));
    }

    std::string drawSeries(size_t index, double legend) {
        const Series& series = series_[index];
        const char* color = kColors[index % kColors.size()];
        std::string out;
        if (series.line && series.points.size() > 1)
            out += path(series.points, std::string("stroke=\"") + color + "\" stroke-width=\"1.5\"");
        for (const Point& p : series.points)
            out += "<g><title>" + escapeMarkup(p.tip) + "</title>" +
                   mark(x_.at(p.x), y_.at(p.y), p.mark, color) + "</g>\n";
        const std::string& letter = series.line ? std::string() : series.points.front().mark;
        out += letter.empty() ? mark(kLegendLeft + 9, legend - 4, "", color)
                              : text(kLegendLeft + 9, legend, "middle", letter, letterStyle(color));
        return out + text(kLegendLeft + 26, legend, "start", series.label);
    }

    std::string title_, yLabel_;
    LogAxis x_{kLeft, kRight}, y_{kBottom, kTop};
    std::vector<Series> series_;
    std::vector<Point> front_;
    std::vector<std::pair<double, double>> marks_;  // that are drawn
};

Point totalPoint(const Measured& m, const std::string& mark) {
    return {m.median(), m.hidden ? 0 : m.error, mark,
            m.family + ", " + shortNumber(m.samples) + " spp: " + shortNumber(m.median()) + " s, error " +
                shortNumber(m.error)};
}

// All families but depths and cuts, in order of measurement.
std::vector<std::string> familiesOf(const SceneReport& scene) {
    std::vector<std::string> families;
    for (const Measured& m : scene.measured)
        if (m.family != "depth" && m.family != "cut" &&
            std::find(families.begin(), families.end(), m.family) == families.end())
            families.push_back(m.family);
    return families;
}

}  // namespace

std::string precisionDiagram(const SceneReport& scene) {
    Drawing drawing(scene.name + ": error against time", "RMSE against the converged image");
    char letter = 'a';
    for (const std::string& family : familiesOf(scene)) {
        const auto points = familyOf(scene, family);
        Series series{family, {}, isSampler(family)};
        if (series.line)
            series.label += " (" + std::to_string(points.front()->spp) + " to " +
                            std::to_string(points.back()->spp) + " spp)";
        const std::string mark = series.line ? "" : std::string(1, letter++);
        for (const Measured* m : points) series.points.push_back(totalPoint(*m, mark));
        drawing.add(std::move(series));
    }
    std::vector<Point> front;
    for (const Measured* m : frontOf(scene))
        if (m->error > 0) front.push_back(totalPoint(*m, ""));
    drawing.setFront(std::move(front));
    return drawing.draw();
}

std::string truncationDiagram(const SceneReport& scene) {
    Drawing drawing(scene.name + ": depth and least contribution, at 4 samples",
                    "RMSE against the whole tree, same samples");
    for (const bool depth : {true, false}) {
        Series series{depth ? "greatest depth" : "least contribution", {}};
        for (const Measured* m : familyOf(scene, depth ? "depth" : "cut")) {
            if (!m->arithmetic) continue;
            const std::string mark = depth ? std::to_string(m->depth) : shortNumber(m->minContribution);
            series.points.push_back({m->median(), m->arithmetic->all.rmse, mark,
                                     series.label + " " + mark + ": " + shortNumber(m->median()) +
                                         " s, error " + shortNumber(m->arithmetic->all.rmse)});
        }
        drawing.add(std::move(series));
    }
    return drawing.draw();
}

}  // namespace glint::report
