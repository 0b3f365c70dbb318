// Cameras from matrices and from renderers' attributes.

#include <gtest/gtest.h>

#include <cmath>

#include "camera_scenes.h"
#include "scene/camera.h"

namespace brume {
namespace {

using namespace test;

// Rays of two views over the same frame, largest difference of directions and origins.
double difference(const View& a, const View& b) {
  double worst = 0;
  for (const double x : {0., 0.3, 1.})
    for (const double y : {0., 0.6, 1.}) {
      const double i = a.display.x + x * a.display.width;
      const double j = a.display.y + y * a.display.height;
      worst = std::max({worst, glm::length(a.ray(i, j).direction - b.ray(i, j).direction),
                        glm::length(a.ray(i, j).origin - b.ray(i, j).origin)});
    }
  return worst;
}

// A camera that looks north-east and a little down, shifted window.
const glm::dvec3 kEye{10, -20, 30};
const glm::dvec3 kForward = glm::normalize(glm::dvec3(1, 1, -0.2));
const glm::dvec3 kRight = glm::normalize(glm::cross(kForward, glm::dvec3(0, 0, 1)));
const glm::dvec3 kUp = glm::cross(kRight, kForward);
const glm::dmat4 kToCamera = world_to_camera(kEye, kRight, kUp, kForward);
constexpr double kLeft = -0.7, kWindowRight = 0.5, kBottom = -0.3, kTop = 0.4;
const glm::dmat4 kToNdc =
    then(kToCamera, perspective_ndc(kLeft, kWindowRight, kBottom, kTop));

View expected(Projection projection = Projection::perspective) {
  return view_of({projection, kEye, kRight, kUp, kForward, kLeft, kBottom,
                  kWindowRight - kLeft, kTop - kBottom},
                 {{0, 0, 1200, 700}, 1});
}

ImageHeader with(std::initializer_list<std::pair<const char*, Attribute>> attributes) {
  ImageHeader h = header(1200, 700);
  for (const auto& [name, value] : attributes) h.attributes[name] = value;
  return h;
}
std::optional<View> found(const ImageHeader& h) {
  return find_view(h, SceneFile{}, 1, "test.exr");
}
// Float matrices: translation off by 2^-24 of 60 m, three of them; directions by 2^-23.
constexpr double kFloat = 2e-5;

TEST(Camera, BothMatricesGiveEyeAxesAndAnOffAxisWindow) {
  const auto v =
      found(with({{"worldToCamera", matrix(kToCamera)}, {"worldToNDC", matrix(kToNdc)}}));
  ASSERT_TRUE(v);
  EXPECT_LT(difference(*v, expected()), kFloat);
  EXPECT_LT(glm::length(v->forward - kForward), 2e-7);  // 3 floats
  EXPECT_EQ(v->source, "worldToCamera, worldToNDC of test.exr");
}
TEST(Camera, WorldToNdcAloneIsEnough) {
  const auto v = found(with({{"worldToNDC", matrix(kToNdc)}}));
  ASSERT_TRUE(v);
  EXPECT_LT(difference(*v, expected()), 10 * kFloat);  // the eye from products of floats
  EXPECT_LT(glm::length(v->right - kRight), 1e-6);
  EXPECT_LT(glm::length(v->up - kUp), 1e-6);
}
TEST(Camera, WithoutWorldToNdcTheScreenWindowIsTheFrustum) {
  const auto v = found(with({{"worldToCamera", matrix(kToCamera)},
                             {"screenWindowCenter", floats("v2f", {-0.1f, 0.05f})},
                             {"screenWindowWidth", floats("float", {1.2f})}}));
  ASSERT_TRUE(v);
  EXPECT_LT(difference(*v, expected()), kFloat);  // 1.2 x 700 / 1200 = 0.7 high
}
TEST(Camera, PixelAspectChangesTheHeightOfTheScreenWindow) {
  ImageHeader h = with({{"worldToCamera", matrix(kToCamera)},
                        {"screenWindowWidth", floats("float", {2.f})}});
  h.pixel_aspect = 2;
  const auto v = found(h);
  ASSERT_TRUE(v);
  EXPECT_NEAR(glm::length(v->across) * 1200, 2, 1e-6);
  EXPECT_NEAR(glm::length(v->down) * 700, 2. / (2400. / 700), 1e-6);
}
TEST(Camera, AScreenWindowLeftAtItsDefaultYieldsToTheLensInMillimetres) {
  const auto plain = with({{"worldToCamera", matrix(kToCamera)},
                           {"screenWindowCenter", floats("v2f", {0, 0})},
                           {"screenWindowWidth", floats("float", {1})}});
  EXPECT_NEAR(glm::length(found(plain)->across) * 1200, 1, 1e-6);
  EXPECT_NE(found(plain)->source.find("check it"), std::string::npos);
  auto lens = plain;
  lens.attributes["focalLengthMM"] = floats("float", {28});
  lens.attributes["sensorWidthMM"] = floats("float", {36});
  EXPECT_NEAR(glm::length(found(lens)->across) * 1200, 36. / 28, 1e-6);
}
TEST(Camera, OrthographicIsSeenInTheMatrix) {
  const auto ndc =
      matrix(then(kToCamera, orthographic_ndc(kLeft, kWindowRight, kBottom, kTop)));
  const auto v = found(with({{"worldToCamera", matrix(kToCamera)}, {"worldToNDC", ndc}}));
  ASSERT_TRUE(v);
  EXPECT_EQ(v->projection, Projection::orthographic);
  EXPECT_LT(difference(*v, expected(Projection::orthographic)), 2 * kFloat);
  // Alone, it does not say how far behind the near plane (0.1) the camera is.
  const auto alone = found(with({{"worldToNDC", ndc}}));
  ASSERT_TRUE(alone);
  const glm::dvec3 apart = alone->ray(300, 200).origin -
                           expected(Projection::orthographic).ray(300, 200).origin;
  EXPECT_LT(glm::length(alone->forward - kForward), 1e-6);
  // The near plane from 1e-4 of depth a metre, a float of 2^-24: 6e-4 m, a few of them.
  EXPECT_LT(glm::length(apart - 0.1 * kForward), 5e-3);
}
TEST(Camera, TheDisplayWindowMayBeginAnywhereAndTheDataWindowDoesNotMatter) {
  ImageHeader h =
      with({{"worldToCamera", matrix(kToCamera)}, {"worldToNDC", matrix(kToNdc)}});
  h.display_window = {-40, 25, 1200, 700};
  h.data_window = {-400, -400, 3000, 3000};
  const auto v = found(h);
  ASSERT_TRUE(v);
  EXPECT_LT(glm::length(v->ray(-40 + 300, 25 + 200).direction -
                        expected().ray(300, 200).direction),
            1e-6);
}
TEST(Camera, ARightHandedCameraSpaceLooksAlongMinusZ) {
  // OpenGL's convention in the attribute: only the sign of z differs.
  const glm::dmat4 gl = world_to_camera(kEye, kRight, kUp, -kForward);
  const auto alone = found(
      with({{"worldToCamera", matrix(gl)}, {"screenWindowWidth", floats("float", {2})}}));
  ASSERT_TRUE(alone);
  EXPECT_LT(glm::length(alone->forward - kForward), 1e-6);
  const auto both =
      found(with({{"worldToCamera", matrix(gl)}, {"worldToNDC", matrix(kToNdc)}}));
  EXPECT_LT(difference(*both, expected()), kFloat);
}
TEST(Camera, TheSignOfHomogeneousCoordinatesDoesNotMatter) {
  const auto v = found(
      with({{"worldToCamera", matrix(kToCamera)}, {"worldToNDC", matrix(-1. * kToNdc)}}));
  EXPECT_LT(difference(*v, expected()), kFloat);
}
TEST(Camera, RenamedAndPrefixedCopiesAreFound) {
  EXPECT_TRUE(found(
      with({{"worldtocamera", matrix(kToCamera)}, {"worldToNDC", matrix(kToNdc)}})));
  const auto v = found(with(
      {{"exr/worldToCamera", matrix(kToCamera)}, {"exr/worldToNDC", matrix(kToNdc)}}));
  ASSERT_TRUE(v);
  EXPECT_NE(v->source.find("exr/worldToCamera"), std::string::npos);
  // As text, as metadata travels through compositing packages.
  std::string text = "{";
  for (int i = 0; i < 4; ++i)
    for (int j = 0; j < 4; ++j) text += std::to_string(kToNdc[i][j]) + " ";
  EXPECT_TRUE(found(with({{"nuke/exr/worldToNDC", Attribute::from_text(text + "}")}})));
}
TEST(Camera, ThereIsNoneWhereNoneIsToldOf) {
  EXPECT_FALSE(found(with({{"screenWindowWidth", floats("float", {1})}})));
}
TEST(Camera, ABrokenOneIsAnError) {
  const auto m = [](double x) { return matrix(glm::dmat4(x)); };
  EXPECT_THROW(found(with({{"worldToCamera", m(0)}})), Error);
  EXPECT_THROW(found(with({{"worldToNDC", m(0)}})), Error);
  EXPECT_THROW(found(with({{"worldToCamera", m(std::nan(""))}})), Error);
  EXPECT_THROW(found(with({{"worldToCamera", floats("v2f", {1, 2})}})), Error);
  glm::dmat4 flat = kToNdc;  // X and Y the same
  for (int i = 0; i < 4; ++i) flat[i][1] = flat[i][0];
  EXPECT_THROW(found(with({{"worldToNDC", matrix(flat)}})), Error);
  EXPECT_THROW(found(with({{"worldToCamera", matrix(kToCamera)},
                           {"screenWindowWidth", floats("float", {0})}})),
               Error);
  ImageHeader empty = with({{"worldToNDC", matrix(kToNdc)}});
  empty.display_window = {};
  EXPECT_THROW(found(empty), Error);
}

// ---- renderers

glm::dmat4 camera_to_world_rows(const glm::dvec3& z) {
  glm::dmat4 m(1);
  m[0] = glm::dvec4(kRight, 0);
  m[1] = glm::dvec4(kUp, 0);
  m[2] = glm::dvec4(z, 0);
  m[3] = glm::dvec4(kEye, 1);
  return m;
}
Pose centred(double width) {
  return {Projection::perspective,
          kEye,
          kRight,
          kUp,
          kForward,
          -0.5 * width,
          -0.5 * width * 700 / 1200,
          width,
          width * 700 / 1200};
}
const Film kFilm{{0, 0, 1200, 700}, 1};

TEST(Camera, VRayByFieldOfViewOrByLens) {
  const auto transform = matrix(camera_to_world_rows(-kForward));
  const auto fov =
      found(with({{"cameraTransform", transform}, {"cameraFov", floats("float", {90})}}));
  ASSERT_TRUE(fov);
  EXPECT_LT(difference(*fov, view_of(centred(2), kFilm)), kFloat);
  const auto lens = found(with({{"cameraTransform", transform},
                                {"cameraAperture", floats("float", {36})},
                                {"cameraFocalLength", floats("float", {18})}}));
  EXPECT_LT(difference(*lens, view_of(centred(2), kFilm)), kFloat);
  EXPECT_THROW(found(with({{"cameraTransform", transform},
                           {"cameraAperture", floats("float", {36})},
                           {"cameraFocalLength", floats("float", {0})}})),
               Error);
}
TEST(Camera, RedshiftInDegreesOrRadiansOrOrthographic) {
  const auto transform = matrix(camera_to_world_rows(kForward));
  for (const float fov : {90.f, 1.5707963f}) {
    const auto v = found(with(
        {{"rs/camera/transform", transform}, {"rs/camera/fov", floats("float", {fov})}}));
    ASSERT_TRUE(v);
    EXPECT_LT(difference(*v, view_of(centred(2), kFilm)), kFloat);
  }
  const auto ortho = found(with({{"rs/camera/transform", transform},
                                 {"rs/camera/orthoHeight", floats("float", {7})}}));
  EXPECT_EQ(ortho->projection, Projection::orthographic);
  EXPECT_NEAR(glm::length(ortho->down) * 700, 7, 1e-5);
}
TEST(Camera, UnrealIsMirroredIntoARightHandedWorld) {
  const auto text = [](const char* t) { return Attribute::from_text(t); };
  const auto v = found(with({{"unreal/camera/curPos/x", text("100.0")},
                             {"unreal/camera/curPos/y", text("200.0")},
                             {"unreal/camera/curPos/z", text("300.0")},
                             {"unreal/camera/curRot/pitch", text("30.0")},
                             {"unreal/camera/curRot/yaw", text("90.0")},
                             {"unreal/camera/curRot/roll", text("0.0")},
                             {"unreal/camera/FinalImage/fov", text("90.0")}}));
  ASSERT_TRUE(v);
  EXPECT_EQ(v->eye, glm::dvec3(100, -200, 300));
  // Yaw 90 turns x forward into y, which is -y here; pitch up is up.
  const double c = std::cos(glm::radians(30.)), s = std::sin(glm::radians(30.));
  EXPECT_LT(glm::length(v->forward - glm::dvec3(0, -c, s)), 1e-12);
  EXPECT_LT(glm::length(v->right - glm::dvec3(-1, 0, 0)), 1e-12);
  EXPECT_LT(glm::length(v->up - glm::dvec3(0, s, c)), 1e-12);
  EXPECT_NEAR(glm::length(v->across) * 1200, 2, 1e-12);
}

}  // namespace
}  // namespace brume
