// The sun's place in the sky against published worked examples.

#include <gtest/gtest.h>

#include <cmath>

#include "num/error.h"
#include "scene/ephemeris.h"
#include "scene/sun.h"

namespace {

using namespace brume;

// The claim is 0.01 degrees; the sources give all their digits.
constexpr double kError = 0.01;

// Reda and Andreas 2004 (NREL/TP-560-34302, revised 2008), table A5.1: Golden, Colorado;
// topocentric elevation before refraction, 39.872046.
TEST(Sun, StandsWhereNrelSaysOverGolden) {
  const auto p =
      sun_position(julian_day("2003-10-17T12:30:30-07:00", "t"), 39.742476, -105.1786);
  EXPECT_NEAR(p.elevation, 39.872046, kError);
  EXPECT_NEAR(p.azimuth, 194.340241, kError);
}

// Meeus 1998, example 25.a: 1992 October 13, 0 h dynamical time (59 s before universal):
// declination -7.78507, right ascension 198.38083. Where its hour angle is 0 and the
// latitude the declination, the sun is in the zenith.
TEST(Sun, IsInTheZenithWhereMeeusPutsIt) {
  const double jd = 2448908.5 - 59. / 86400;
  const double sidereal = 280.46061837 + 360.98564736629 * (jd - 2451545);
  const double longitude = 198.38083 - sidereal + 360 * std::round(sidereal / 360);
  EXPECT_GT(sun_position(jd, -7.78507, longitude).elevation, 90 - kError);
}

// By definition of the seasons: on the tropics' day at local noon the sun stands at 90 -
// |latitude - 23.44|.
TEST(Sun, CulminatesByTheObliquityAtTheSolstice) {
  double highest = -90, azimuth = 0;
  for (int minute = 0; minute < 1440; ++minute) {
    const auto p =
        sun_position(julian_day("2024-06-20T00:00:00Z", "t") + minute / 1440., 50, 10);
    if (p.elevation > highest) highest = p.elevation, azimuth = p.azimuth;
  }
  // Obliquity in 2024: 23.436; a minute of time is up to .13 degrees of azimuth here.
  EXPECT_NEAR(highest, 90 - (50 - 23.436), 0.01);
  EXPECT_NEAR(azimuth, 180, 0.5);
}

TEST(Sun, ZonesNameTheSameMoment) {
  EXPECT_EQ(julian_day("2024-06-21T18:30:00+02:00", "t"),
            julian_day("2024-06-21T16:30:00Z", "t"));
  EXPECT_EQ(julian_day("2000-01-01T12:00Z", "t"), 2451545.0);  // J2000, the epoch itself
  EXPECT_EQ(julian_day("1999-12-31T23:00-13:00", "t"), 2451545.0);
}

TEST(Sun, RefusesTimesThatAreNone) {
  for (const char* bad :
       {"", "2024-06-21", "2024-06-21T18:30:00", "2023-02-29T12:00Z", "2024-13-01T00:00Z",
        "2024-06-21T18:30:00+2", "2024-06-21T25:00Z", "2024-06-21T18:30Zx"})
    EXPECT_THROW(julian_day(bad, "[sun]"), Error) << bad;
}

TEST(Sun, TimeReplacesElevationAndHoursMoveIt) {
  SunSection s;
  s.time = "2003-10-17T12:00:30-07:00";
  s.hours = 0.5;
  s.latitude = 39.742476, s.longitude = -105.1786;
  const auto d = direction_to_sun(s, {0, 0, 1});
  EXPECT_NEAR(std::asin(d.z) * 180 / M_PI, 39.872046, kError);
}

}  // namespace
