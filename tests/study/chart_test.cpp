// The page without a browser: pictures that decode, charts and tables that hold every
// point.

#include "study/chart.h"

#include <gtest/gtest.h>
#include <libdeflate.h>

#include <cstring>

#include "picture/png.h"
#include "study/page.h"
#include "study/report.h"

namespace {

using namespace brume;
using namespace brume::study;

std::size_t count(const std::string& text, const std::string& what) {
  std::size_t n = 0;
  for (std::size_t at = 0; (at = text.find(what, at)) != std::string::npos; ++at) ++n;
  return n;
}

Study sample() {
  Study s;
  s.in = "shot<1>.exr";
  s.width = 100, s.height = 50;
  Subject subject;
  subject.name = "fog & mist";
  subject.whole = true;
  subject.grid_width = 2, subject.grid_height = 1;
  for (const MethodKind k : {MethodKind::ours, MethodKind::marching}) {
    Method m{k, k == MethodKind::ours ? "brume" : "even steps", {}};
    for (int i = 1; i <= 3; ++i) {
      Point p;
      p.setting = std::to_string(i) + " steps";
      p.per_pixel = {i * 1e-9, i * 1.1e-9, i * 1.2e-9};
      p.seconds = 5000 * p.per_pixel.median;
      p.color.max = k == MethodKind::ours && i == 3 ? 0 : 0.1 / i;
      p.map = {0.1f, 0.0f};
      m.points.push_back(p);
    }
    subject.methods.push_back(m);
  }
  s.subjects.push_back(subject);
  return s;
}

TEST(Chart, HasEveryPointInsideAndNothingThatIsNoNumber) {
  const Study s = sample();
  const std::string svg = chart_svg(s, s.whole());
  EXPECT_EQ(count(svg, "worst error "), 6u + 1);  // one in the axis' name
  EXPECT_EQ(count(svg, "nan") + count(svg, "inf"), 0u);
  EXPECT_NE(svg.find("fog &amp; mist"), std::string::npos);
  for (std::size_t at = 0; (at = svg.find("cx='", at)) != std::string::npos; ++at) {
    const double x = std::stod(svg.substr(at + 4));
    EXPECT_GT(x, 70);
    EXPECT_LT(x, 845);
  }
}

TEST(Chart, ItsLegendHidesNoPoint) {
  Study s = sample();
  s.subjects[0].methods[1].name = std::string(120, 'm');  // another row
  const std::string svg = chart_svg(s, s.whole());
  const auto number_after = [&](const char* what, std::size_t from) {
    return std::stod(svg.substr(svg.find(what, from) + std::strlen(what)));
  };
  // What comes after the last point is the legend.
  const std::size_t end = svg.rfind("</title>");
  double lowest = 0, highest = 1e9;
  for (std::size_t at = end; (at = svg.find("<text", at + 1)) != std::string::npos;)
    lowest = std::max(lowest, number_after(" y='", at));
  for (std::size_t at = 0; (at = svg.find("<circle", at + 1)) < end;)
    highest = std::min(highest, number_after("cy='", at));
  EXPECT_GT(lowest, 40);
  EXPECT_LT(lowest, highest - 5);
}

TEST(Chart, OfNothingIsNothing) { EXPECT_EQ(chart_svg({}, {}), ""); }

TEST(Data, HasARowForEveryPoint) {
  const Study s = sample();
  EXPECT_EQ(count(csv(s), "\n"), 1u + 6);
  EXPECT_EQ(count(markdown(s, s.whole()), "\n"), 2u + 6);
  const std::string text = json(s, "brume study");
  EXPECT_EQ(count(text, "\"setting\""), 6u);
}

TEST(Page, SaysOnceWhatIsTrueOfSeveral) {
  Study s = sample();
  s.notes = {"lamp1: is dark", "lamp2: is dark", "haze: density is 0", "lamp3: is dark"};
  const std::string text = page(s, json(s, ""), "", {});
  EXPECT_EQ(count(text, "<p class='soft'>lamp1, lamp2: is dark</p>"), 1u);
  EXPECT_EQ(count(text, "<p class='soft'>haze: density is 0</p>"), 1u);
  EXPECT_EQ(count(text, "<p class='soft'>lamp3: is dark</p>"), 1u);
}

TEST(Page, CarriesItsDataAndEscapesWhatIsGivenToIt) {
  const Study s = sample();
  const std::string text = page(s, json(s, "</script><b>"), "</script><b>", {});
  EXPECT_EQ(count(text, "<b>"), 0u + 1);  // inside the data, where it is text
  EXPECT_EQ(count(text, "</script>"), 2u);
  EXPECT_NE(text.find("shot&lt;1&gt;.exr"), std::string::npos);
  EXPECT_EQ(count(text, "http://") - count(text, "http://www.w3.org/2000/svg"), 0u);
  EXPECT_EQ(count(text, "https://"), 0u);
}

TEST(Png, DecodesToWhatWentIn) {
  Picture p(7, 5);
  for (std::size_t i = 0; i < p.rgb.size(); ++i) p.rgb[i] = float(i % 11) / 10;
  const std::string bytes = png(p);
  ASSERT_EQ(bytes.substr(1, 3), "PNG");
  const std::size_t at = bytes.find("IDAT");
  std::uint32_t size = 0;
  for (int k = 0; k < 4; ++k)
    size = size << 8 | std::uint8_t(bytes[at - 4 + std::size_t(k)]);
  std::string raw(5 * (1 + 21), '\0');
  libdeflate_decompressor* with = libdeflate_alloc_decompressor();
  ASSERT_EQ(libdeflate_zlib_decompress(with, bytes.data() + at + 4, size, raw.data(),
                                       raw.size(), nullptr),
            LIBDEFLATE_SUCCESS);
  libdeflate_free_decompressor(with);
  std::vector<int> above(21, 0);
  for (std::size_t y = 0; y < 5; ++y) {
    const int filter = raw[22 * y];
    std::vector<int> row(21);
    for (std::size_t i = 0; i < 21; ++i) {
      const int left = i < 3 ? 0 : row[i - 3], up = above[i],
                corner = i < 3 ? 0 : above[i - 3];
      const int q = left + up - corner;
      const int a = std::abs(q - left), b = std::abs(q - up), c = std::abs(q - corner);
      const int guess[] = {0, left, up, (left + up) / 2,
                           a <= b && a <= c ? left
                           : b <= c         ? up
                                            : corner};
      row[i] = (guess[filter] + std::uint8_t(raw[22 * y + 1 + i])) & 255;
      const float wanted = srgb_encoded(p.rgb[21 * y + i]) * 255;
      EXPECT_NEAR(row[i], wanted, 0.5001) << y << " " << i;
    }
    above = row;
  }
}

TEST(Base64, IsThatOfTheRfc) {  // RFC 4648, section 10
  EXPECT_EQ(base64(""), "");
  EXPECT_EQ(base64("f"), "Zg==");
  EXPECT_EQ(base64("fo"), "Zm8=");
  EXPECT_EQ(base64("foobar"), "Zm9vYmFy");
}

}  // namespace
