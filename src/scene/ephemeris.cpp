#include "scene/ephemeris.h"

#include <cmath>
#include <numbers>
#include <string>

#include "num/error.h"

namespace brume {
namespace {

constexpr double kDegree = std::numbers::pi / 180;

// Gregorian date to Julian day at 0 h (Meeus, chapter 7).
double julian_day_of(int year, int month, int day) {
  if (month <= 2) --year, month += 12;
  const int century = year / 100;
  return std::floor(365.25 * (year + 4716)) + std::floor(30.6001 * (month + 1)) + day +
         2 - century + century / 4 - 1524.5;
}

int days_in(int year, int month) {
  constexpr int days[] = {31, 28, 31, 30, 31, 30, 31, 31, 30, 31, 30, 31};
  const bool leap = (year % 4 == 0 && year % 100 != 0) || year % 400 == 0;
  return month == 2 && leap ? 29 : days[month - 1];
}

// Dynamical less universal time [s]: within 15 s from 1900 to 2100, which the sun takes
// for 0.0002 degrees (a line through Espenak and Meeus 2006).
double delta_t(double years_since_2000) { return 64 + 0.6 * years_since_2000; }

}  // namespace

SunPosition sun_position(double jd, double latitude, double longitude) {
  // Apparent longitude of the sun, obliquity: equations 25.2 to 25.8.
  const double T_ut = (jd - 2451545) / 36525;
  const double T = T_ut + delta_t(100 * T_ut) / (86400. * 36525);
  const double L0 = 280.46646 + T * (36000.76983 + T * 0.0003032);
  const double M = kDegree * (357.52911 + T * (35999.05029 - T * 0.0001537));
  const double centre = (1.914602 - T * (0.004817 + T * 0.000014)) * std::sin(M) +
                        (0.019993 - T * 0.000101) * std::sin(2 * M) +
                        0.000289 * std::sin(3 * M);
  const double omega = kDegree * (125.04 - 1934.136 * T);
  const double lambda = kDegree * (L0 + centre - 0.00569 - 0.00478 * std::sin(omega));
  const double mean_obliquity =
      23.4392911 - T * (0.0130042 + T * (1.64e-7 - T * 5.04e-7));
  const double epsilon = kDegree * (mean_obliquity + 0.00256 * std::cos(omega));
  const double ascension =
      std::atan2(std::cos(epsilon) * std::sin(lambda), std::cos(lambda));
  const double declination = std::asin(std::sin(epsilon) * std::sin(lambda));

  // Apparent sidereal time: equation 12.4 and the nutation above, projected on the
  // equator.
  const double sidereal = 280.46061837 + 360.98564736629 * (jd - 2451545) +
                          T_ut * T_ut * 0.000387933 -
                          0.00478 * std::sin(omega) * std::cos(epsilon);
  const double H = kDegree * (sidereal + longitude) - ascension;

  // To the horizon: equations 13.5 and 13.6, azimuth from north; then the parallax
  // of 8.794".
  const double phi = kDegree * latitude;
  const double azimuth = std::atan2(
      std::sin(H), std::cos(H) * std::sin(phi) - std::tan(declination) * std::cos(phi));
  double elevation = std::asin(std::sin(phi) * std::sin(declination) +
                               std::cos(phi) * std::cos(declination) * std::cos(H));
  elevation -= kDegree * 8.794 / 3600 * std::cos(elevation);
  const double from_north = azimuth / kDegree + 180;
  return {elevation / kDegree, from_north - 360 * std::floor(from_north / 360)};
}

double julian_day(std::string_view time, std::string_view where) {
  std::size_t at = 0;
  const auto wrong = [&]() -> Error {
    return Error(std::string(where), "time \"" + std::string(time) + "\"",
                 "a date that exists, as 2024-06-21T18:30:00+02:00 or ending in Z");
  };
  const auto digits = [&](int count) {
    int value = 0;
    for (int i = 0; i < count; ++i, ++at) {
      if (at >= time.size() || time[at] < '0' || time[at] > '9') throw wrong();
      value = 10 * value + (time[at] - '0');
    }
    return value;
  };
  const auto expect = [&](std::string_view any) {
    if (at >= time.size() || any.find(time[at]) == any.npos) throw wrong();
    return time[at++];
  };
  const int year = digits(4);
  expect("-");
  const int month = digits(2);
  expect("-");
  const int day = digits(2);
  expect("T ");
  const int hour = digits(2);
  expect(":");
  const int minute = digits(2);
  double second = 0;
  if (at < time.size() && time[at] == ':') {
    ++at;
    second = digits(2);
    if (at < time.size() && time[at] == '.') {
      ++at;
      for (double unit = 0.1; at < time.size() && time[at] >= '0' && time[at] <= '9';
           unit /= 10)
        second += unit * (time[at++] - '0');
    }
  }
  double zone = 0;
  if (const char sign = expect("Z+-"); sign != 'Z') {
    const int hours = digits(2);
    expect(":");
    const int minutes = digits(2);
    if (hours > 18 || minutes > 59) throw wrong();
    zone = (sign == '-' ? -1 : 1) * (hours * 60 + minutes);
  }
  if (at != time.size() || year < 1583 || month < 1 || month > 12 || day < 1 ||
      day > days_in(year, month) || hour > 24 || minute > 59 || second >= 61)
    throw wrong();
  return julian_day_of(year, month, day) + (hour * 60 + minute - zone) / 1440 +
         second / 86400;
}

}  // namespace brume
