#pragma once
// Where the sun stands over a place on earth at a time.

#include <string_view>

namespace brume {

/// As seen from the place, without refraction [degrees]: elevation above the horizon,
/// azimuth clockwise from north.
struct SunPosition {
  double elevation, azimuth;
};

/// `julian_day`: in universal time. latitude north, longitude east [degrees]. Within 0.01
/// degrees from 1900 to 2100. Meeus 1998, Astronomical Algorithms, chapters 12, 13, 22
/// (its largest nutation), 25 (low accuracy) and 40 (parallax).
SunPosition sun_position(double julian_day, double latitude, double longitude);

/// Julian day, universal time, of "2024-06-21T18:30:00+02:00"; seconds and their decimals
/// may be left out, the zone is +hh:mm, -hh:mm or Z and must be there. Throws Error
/// naming `where` for anything else and for dates that do not exist.
double julian_day(std::string_view time, std::string_view where);

}  // namespace brume
