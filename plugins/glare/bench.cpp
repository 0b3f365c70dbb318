// Time of a frame's convolution: ours, plain float FFT with the same library, and cv::dft
// (README.md, "Time"). One thread; seconds of the processor, the best of `repeat`.

#include <tbb/task_arena.h>
#include <time.h>

#include <cstdio>
#include <cstdlib>
#include <opencv2/core.hpp>
#include <pythran/pythonic/numpy/fft/pocketfft.hpp>
#include <random>

#include "convolve.h"

using namespace brume::glare;

template <class F>
double best(int repeat, F&& f) {
  const auto now = [] {
    timespec t;
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
    return double(t.tv_sec) + 1e-9 * double(t.tv_nsec);
  };
  double least = 1e9;
  for (int i = 0; i < repeat; ++i) {
    const double begin = now();
    f();
    least = std::min(least, now() - begin);
  }
  return least;
}

void measure(int w, int h, int repeat) {
  std::mt19937 random(1);
  std::vector<float> frame(std::size_t(w) * std::size_t(h));
  for (float& v : frame) v = float(random() >> 8) / (1 << 24);
  for (int i = 0; i < 40; ++i) frame[random() % frame.size()] = 1e7f;
  const auto p = prepare(make_kernel({}, w, h), w, h, kCacheBytes);
  const std::size_t W = p->layout.W, H = p->layout.H, wide = W / 2 + 1;

  std::vector<Complex> room;
  const double ours = best(repeat, [&] {
    for (int c = 0; c < 3; ++c)
      convolve(*p, c, {frame.data(), nullptr, w}, room,
               [&](std::size_t, const double*) {});
  });

  // The whole padded plane forward, times a spectrum, and back.
  std::vector<float> plane(W * H);
  std::vector<std::complex<float>> f(wide * H), kernel(wide * H, 1.f);
  const pocketfft::shape_t shape{H, W}, axes{0, 1};
  const pocketfft::stride_t real{std::ptrdiff_t(4 * W), 4},
      complex{std::ptrdiff_t(8 * wide), 8};
  const auto pad = [&](float* to) {
    for (int y = 0; y < h; ++y)
      std::copy_n(&frame[std::size_t(y) * std::size_t(w)], w, to + std::size_t(y) * W);
  };
  const double plain = best(repeat, [&] {
    for (int c = 0; c < 3; ++c) {
      std::fill(plane.begin(), plane.end(), 0.f);
      pad(plane.data());
      pocketfft::r2c(shape, real, complex, axes, true, plane.data(), f.data(), 1.f);
      for (std::size_t i = 0; i < f.size(); ++i) f[i] *= kernel[i].real();
      pocketfft::c2r(shape, complex, real, axes, false, f.data(), plane.data(), 1.f);
    }
  });

  const int cw = cv::getOptimalDFTSize(int(W)), ch = cv::getOptimalDFTSize(int(H));
  const auto opencv = [&](int type) {
    cv::Mat in(ch, cw, type), k = cv::Mat::ones(ch, cw, type), out;
    return best(repeat, [&] {
      for (int c = 0; c < 3; ++c) {
        in = 0;
        cv::Mat(h, w, CV_32F, frame.data()).convertTo(in(cv::Rect(0, 0, w, h)), type);
        cv::dft(in, out);
        cv::mulSpectrums(out, k, out, 0);
        cv::dft(out, out, cv::DFT_INVERSE | cv::DFT_SCALE);
      }
    });
  };
  const double cv4 = opencv(CV_32F), cv8 = opencv(CV_64F);
  std::printf(
      "%dx%d padded %zux%zu: ours %.3f s, plain float %.3f (ours / it %.2f), "
      "cv::dft float %.3f (%.2f), double %.3f (%.2f)\n",
      w, h, W, H, ours, plain, ours / plain, cv4, ours / cv4, cv8, ours / cv8);
}

// An aperture's pattern, from the pupil on: pixels finer than its rings, as fine,
// coarser.
void measure_patterns(int repeat) {
  for (const double step : {0.01, 0.5, 4., 400.}) {
    PatternSettings s;
    s.kind = "aperture";
    s.pixel = step * 550e-9 / s.aperture;
    const double made = best(repeat, [&] { make_kernel(s, 1920, 1080); });
    std::printf("aperture, pixels of %g lambda / D, 1920x1080: %.2f s\n", step, made);
  }
}

int main(int argc, char** argv) {
  cv::setNumThreads(1);
  const int repeat = argc > 1 ? std::atoi(argv[1]) : 3;
  tbb::task_arena(1).execute([&] {
    measure(1920, 1080, repeat);
    measure(3840, 2160, repeat);
    measure_patterns(repeat);
  });
}
