// The drawing module: scaling, labels, colour bars, with OpenCV. Opened by montage() in
// picture.cpp, so that only who draws pays for loading OpenCV (4 ms).

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>
#include <string>

#include "picture/module.h"

namespace brume {

namespace {

const cv::Scalar kInk(0.75, 0.75, 0.75), kPaper(0.012, 0.012, 0.012);
constexpr int kFont = cv::FONT_HERSHEY_SIMPLEX;

cv::Mat scaled(const Picture& p, int width) {
  const cv::Mat full(p.height, p.width, CV_32FC3, const_cast<float*>(p.rgb.data()));
  if (width == 0 || width == p.width) return full.clone();
  const int height = std::max(1, int(std::lround(double(p.height) * width / p.width)));
  cv::Mat out;
  cv::resize(full, out, {width, height}, 0, 0,
             width < p.width ? cv::INTER_AREA : cv::INTER_LINEAR);
  return out;
}

int thickness(double scale) { return std::max(1, int(std::lround(scale * 1.2))); }

int width_of(const std::string& text, double scale) {
  int below = 0;
  return cv::getTextSize(text, kFont, scale, thickness(scale), &below).width;
}

void write(cv::Mat& on, const std::string& text, int x, int baseline, double scale) {
  cv::putText(on, text, {x, baseline}, kFont, scale, kInk, thickness(scale), cv::LINE_AA);
}

std::string number_text(double v) {
  char text[32];
  std::snprintf(text, sizeof text, "%.4g", v);
  return text;
}

// The strip below a picture: its label at the left, its colour bar at the right.
void caption(cv::Mat strip, const Tile& tile) {
  const double scale = strip.rows / 40.0;
  const int margin = strip.rows / 3, baseline = int(strip.rows * 0.68);
  write(strip, tile.label, margin, baseline, scale);
  if (!tile.has_range) return;
  const Range& r = tile.range;
  const std::string low = number_text(r.low),
                    high = number_text(r.high) + (r.logarithmic ? " log" : "");
  const int bar = strip.cols / 4, right = strip.cols - 2 * margin - width_of(high, scale),
            left = right - bar;
  if (left < 0) return;
  for (int x = left; x < right; ++x) {
    const auto c = false_color(float(x - left) / float(bar));
    strip(cv::Rect(x, strip.rows / 3, 1, std::max(1, strip.rows / 3)))
        .setTo(cv::Scalar(c[0], c[1], c[2]));
  }
  write(strip, low, left - margin - width_of(low, scale), baseline, scale);
  write(strip, high, right + margin, baseline, scale);
}

void draw(const Tile* tiles, std::size_t count, const Montage& how, Picture& out) {
  std::vector<cv::Mat> pictures;
  int width = 0, height = 0;
  bool captions = false;
  for (std::size_t i = 0; i < count; ++i) {
    pictures.push_back(scaled(tiles[i].picture, how.width));
    width = std::max(width, pictures.back().cols);
    height = std::max(height, pictures.back().rows);
    captions |= !tiles[i].label.empty() || tiles[i].has_range;
  }
  const int n = int(count);
  const int columns =
      std::min(n, how.columns > 0 ? how.columns : int(std::ceil(std::sqrt(double(n)))));
  const int rows = (n + columns - 1) / columns;
  const int gap = n > 1 ? std::max(2, width / 240) : 0;
  const int strip = captions ? std::clamp(width / 32, 16, 48) : 0;
  out = Picture(columns * width + (columns - 1) * gap,
                rows * (height + strip) + (rows - 1) * gap);
  cv::Mat sheet(out.height, out.width, CV_32FC3, out.rgb.data());
  sheet.setTo(kPaper);
  for (int i = 0; i < n; ++i) {
    const cv::Mat& p = pictures[std::size_t(i)];
    const int x = (i % columns) * (width + gap),
              y = (i / columns) * (height + strip + gap);
    p.copyTo(sheet(cv::Rect(x, y, p.cols, p.rows)));
    if (captions) caption(sheet(cv::Rect(x, y + height, width, strip)), tiles[i]);
  }
  for (float& v : out.rgb) v = std::clamp(v, 0.0f, 1.0f);
}

}  // namespace

}  // namespace brume

extern "C" __attribute__((visibility("default"))) void brume_picture_montage(
    const brume::Tile* tiles, std::size_t count, const brume::Montage& how,
    brume::Picture& out) {
  brume::draw(tiles, count, how, out);
}
