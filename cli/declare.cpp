#include "declare.h"

#include <fmt/format.h>

#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <cmath>

namespace brume::cli {

namespace {

void scene_options(Command& c, SceneArguments& a) {
  c.option("--set", "NAME.PARAM=VALUE", a.set,
           "Change one value of the scene, e.g. height_fog.density=0.004, "
           "sun.elevation=3, output.white=2; may be repeated");
  c.option("--plugin", "FILE", a.plugins,
           "Load stages from this module (.so); may be repeated");
}

// CLI::Range writes its ends with six decimals: 1e-12 as 0.000000.
CLI::Validator between(double least, double most) {
  return CLI::Validator(
      [=](const std::string& text) {
        double v = NAN;
        if (CLI::detail::lexical_cast(text, v) && v >= least && v <= most)
          return std::string();
        return fmt::format("Value {} not in range {} to {}", text, least, most);
      },
      "", "");
}

const char* const kScene = "The scene: a TOML file that lists the stages";
const char* const kFrames =
    "Frames of a sequence: 1001-1024, 1-100x2 (every second), 1,5,9; default: all that "
    "exist";
const std::vector<std::string> kCompressions = {"none",  "rle", "zips", "zip",  "piz",
                                                "pxr24", "b44", "b44a", "dwaa", "dwab"};

}  // namespace

void declare_apply(Command& c, ApplyArguments& a, std::string& region,
                   std::string& on_missing) {
  c.argument("SCENE", a.scene.scene, kScene)->required();
  c.argument("IN", a.in, "Frames: files, or a sequence as shot.####.exr or shot.%04d.exr")
      ->required();
  c.option("-o,--output", "OUT", a.out,
           "Where to write: a file, a sequence (out.####.exr), or a folder ending in / "
           "that keeps the names of the input. Folders are made when missing");
  c.usually_needed();
  c.option("--frames", "LIST", a.frames, kFrames);
  c.option("--on-missing", "WHAT", on_missing,
           "A frame of the list that does not exist: stop before anything runs "
           "(default), or skip it",
           {"stop", "skip"});
  c.flag("--overwrite", a.overwrite, "Replace outputs that exist");
  c.flag("--skip-existing", a.skip_existing,
         "Leave outputs that exist as they are and make the others: a safe restart");
  c.option("--region", "X,Y,W,H", region,
           "Only these pixels, for look-dev; they are the pixels of the whole frame");
  c.option("--proxy", "N", a.proxy, "Every N-th pixel each way, for look-dev")
      ->check(CLI::Range(1, 64));
  c.option(
      "--aovs", "LIST", a.scene.aovs,
      "Layers to write beside the picture: T (what the air lets through), L (what it "
      "adds), a stage's share as height_fog.L, S (the surfaces), what a stage of surface "
      "or lens adds as relight; \"\" for none");
  c.option("--compression", "WORD", a.scene.compression,
           "Compression of the output; default: as the scene says, else as the input",
           kCompressions);
  scene_options(c, a.scene);
  c.option("--threads", "N", a.threads, "Threads; default: all (BRUME_THREADS)")
      ->envname("BRUME_THREADS")
      ->check(CLI::Range(0, 1024));
  c.option("--report", "FILE", a.report,
           "Write what ran, what was left out and why, and what it took, as JSON");
  c.flag("--truth", a.truth,
         "Render in double, converged, pixel by pixel (slow): for small frames");
  c.option("--check", "N", a.check,
           "Write nothing: compare N pixels (horizon, grazing, silhouettes, near, far, "
           "bright, sky) with the truth, and say whether the scene's tolerance is kept; "
           "exit 1 where not")
      ->check(CLI::Range(1, 100000000));
  c.example("brume apply fog.toml shot.1001.exr -o fog.1001.exr", "one frame");
  c.example("brume apply fog.toml shot.####.exr -o fog/shot.####.exr",
            "a sequence, all frames that exist");
  c.example("brume apply fog.toml shot.####.exr -o fog/ --frames 1001-1100x10 --proxy 4",
            "a quick look at every tenth frame, a quarter of the size");
  c.example(
      "brume apply fog.toml a.exr -o b.exr --set height_fog.density=0.004 --overwrite",
      "the same scene, thicker");
}

void declare_plan(Command& c, PlanArguments& a) {
  c.argument("SCENE", a.scene.scene, kScene)->required();
  c.argument("IN", a.in, "Frames, as for apply")->required();
  c.option("--frames", "LIST", a.frames, kFrames);
  c.flag("--json", a.json, "As JSON");
  scene_options(c, a.scene);
  c.example("brume plan fog.toml shot.1001.exr",
            "which channel is the depth, where the camera came from, what runs");
}

void declare_info(Command& c, InfoArguments& a) {
  c.argument("IN", a.in, "Image files")->required();
  c.flag("--json", a.json, "As JSON");
  c.example("brume info shot.1001.exr", "channels, depth, camera, attributes");
}

void declare_stages(Command& c, StagesArguments& a) {
  c.argument("NAME", a.name, "A stage: its parameters with units, ranges and defaults");
  c.flag("--json", a.json, "As JSON");
  c.flag("--schema", a.schema, "The JSON schema of the stage's table, for editors");
  c.flag("--names", a.names, "Only the names, one a line");
  c.option("--plugin", "FILE", a.plugins,
           "Load stages from this module (.so) too; may be repeated");
  c.example("brume stages", "what there is");
  c.example("brume stages height_fog", "what it can do");
}

void declare_probe(Command& c, ProbeArguments& a) {
  c.argument("SCENE", a.scene.scene, kScene)->required();
  c.argument("RAYS", a.rays,
             "CSV file, - for standard input. Its first line is "
             "ox,oy,oz,dx,dy,dz,distance, or that and r,g,b")
      ->required();
  c.option("--frame", "N", a.frame, "The frame of keyframed values; default 0");
  c.flag("--truth", a.truth,
         "Answer in double, converged, by the media's physics at points (slow), and add "
         "the columns T_error and L_error");
  scene_options(c, a.scene);
  c.example(
      "printf 'ox,oy,oz,dx,dy,dz,distance\\n0,0,2,0,1,0,500\\n' | "
      "brume probe fog.toml -",
      "what 500 m of air do, 2 m above the ground");
}

void declare_view(Command& c, ViewArguments& a) {
  c.argument("IN", a.in, "Images: file, or file:layer for one of its layers")->required();
  c.option("-o,--output", "OUT", a.out, "The picture: .png, .jpg, ...")->required();
  c.option("--layer", "NAME", a.layer,
           "Draw this layer or channel of each image: T, L, Z, height_fog.L");
  c.option("--exposure", "STOPS", a.exposure, "Make brighter (or darker)");
  c.option("--curve", "WORD", a.curve,
           "filmic (default: rolls highlights off) or linear (clips)",
           {"filmic", "linear"});
  c.option("--range", "A,B", a.range,
           "False colour of a single channel goes from A to B; default: its own range");
  c.option("--background", "R,G,B", a.background,
           "Scene light behind what the picture does not cover; default: none");
  c.option("--label", "TEXT", a.labels,
           "Caption of a picture, in their order; default: the names of the files");
  c.option("--columns", "N", a.columns, "Pictures side by side; default: a square")
      ->check(CLI::Range(1, 64));
  c.option("--width", "N", a.width, "Scale each picture to this width")
      ->check(CLI::Range(8, 16384));
  c.flag("--overwrite", a.overwrite, "Replace the picture if it exists");
  c.example("brume view shot.1001.exr -o shot.png", "the picture");
  c.example("brume view shot.1001.exr --layer Z -o depth.png", "depth in false colour");
  c.example(
      "brume view shot.1001.exr fog.1001.exr fog.1001.exr:T -o look.png --width 960",
      "before, after and transmittance side by side");
}

void declare_diff(Command& c, DiffArguments& a) {
  c.argument("A", a.a, "Image or sequence (shot.####.exr): the reference")->required();
  c.argument("B", a.b, "What is compared with it")->required();
  c.option("--frames", "LIST", a.frames, kFrames);
  c.option("--metric", "WORD", a.metric,
           "What the limits are about: max (default), differences of samples; or one "
           "number: rms, psnr [dB] and ssim per channel, flip of the picture",
           {"max", "rms", "psnr", "ssim", "flip"});
  c.option("--fail", "LIMIT", a.fail,
           "A number, or CHANNEL=NUMBER where * in the channel stands for anything "
           "(\"T.*=1e-3\"); "
           "may be repeated, the last that fits holds. Above it (psnr, ssim: below) they "
           "differ; default: anything but equality");
  c.option("--warn", "LIMIT", a.warn, "The same for a warning; default: none");
  c.option("--fail-percent", "P", a.fail_percent,
           "So much of a channel's samples may be above --fail")
      ->check(between(0., 100.));
  c.option("--warn-percent", "P", a.warn_percent, "The same for --warn")
      ->check(between(0., 100.));
  c.option("--hard-fail", "D", a.hard_fail, "But no sample may be above this");
  c.option("--relative", "FLOOR", a.relative,
           "Differences relative to the larger of the two values, or to FLOOR where that "
           "is larger");
  c.option("--ignore-channels", "LIST", a.ignore_channels,
           "Names with commas; * as above");
  c.option("--ignore-attributes", "LIST", a.ignore_attributes,
           "Likewise: \"brume/*,capDate\"; * for all");
  c.flag("--nan-equal", a.nan_equal, "NaN and NaN are the same");
  c.option("--peak", "V", a.peak, "The brightest value, for psnr and ssim; default 1");
  c.option("-o,--output", "OUT", a.out, "Draw the difference: .exr, .png, ...");
  c.option("--picture", "WORD", a.picture,
           "What is drawn: absolute (default), signed (B - A), or flip in false colour. "
           "EXR and TIFF hold the numbers; elsewhere the alpha is left out, and signed "
           "is mid grey where A and B agree, white and black at the picture's largest "
           "difference",
           {"absolute", "signed", "flip"});
  c.flag("--json", a.json, "As JSON");
  c.flag("--overwrite", a.overwrite, "Replace the drawing if it exists");
  c.example("brume diff before.exr after.exr", "are they the same?");
  c.example("brume diff a.exr b.exr --fail 1e-3 --fail Z=0.1 --hard-fail 1",
            "within limits?");
  c.example("brume diff a.####.exr b.####.exr --metric flip --fail 0.01 -q",
            "do people see a difference in any frame?");
}

void declare_stress(Command& c, StressArguments& a) {
  c.argument("STAGE", a.stages, "Stages; default: all there are");
  c.option("--cases", "N", a.cases, "Cases against laws per stage; default 1000000")
      ->check(between(1., 1e15));
  c.option("--seconds", "S", a.seconds,
           "Time per stage; a quarter of it is kept for the truth, and a world that "
           "takes a tenth is given up; default 60")
      ->check(between(0.1, 1e6));
  c.option("--seed", "S", a.seed, "Other cases")->check(between(0., 1e15));
  c.option("--case", "N", a.only, "This case's world alone, as a report names it");
  c.option("--json", "FILE", a.json, "Write the findings as JSON");
  c.option("--plugin", "FILE", a.plugins,
           "Load stages from this module (.so) too; may be repeated");
  c.example("brume stress height_fog", "a million rays through a thousand fogs");
  c.example("brume stress --plugin ./brume_mine.so mine --seconds 10",
            "does a stage of one's own hold?");
}

void declare_study(Command& c, StudyArguments& a) {
  c.argument("SCENE", a.scene.scene, kScene)->required();
  c.argument("IN", a.in, "A frame: a file, or a sequence as for apply (its first frame)")
      ->required();
  c.option("-o,--output", "FILE.html", a.out,
           "Write the report: one page that needs nothing else, with study.csv and "
           "study.json beside it. Without it the figures are printed");
  c.option("--budget", "TIME", a.budget,
           "Print the settings with the least error whose air takes no longer than this "
           "for the frame on one core (0.5s, 20ms)");
  c.option("--error", "E", a.error,
           "Print the fastest settings whose error |dC| / (white + |C|) is nowhere more")
      ->check(between(1e-12, 1e6));
  c.option("--chart", "FILE.svg", a.chart, "Write the chart of the whole scene alone");
  c.option("--table", "FILE.md", a.table, "Write the table of the whole scene alone");
  c.option("--frame", "N", a.frame, "The frame of keyframed values; default: the file's");
  c.option(
       "--seconds", "S", a.seconds,
       "So long it may take on an idle machine, once frame and tables are read; "
       "default 40. A stage of surface or lens is run twice each way at least, and 64 "
       "rays are held against the truth, however long that takes. More time holds "
       "more of them against it")
      ->check(between(1., 1e6));
  c.option("--repeats", "N", a.repeats, "Of each timing; default 9")
      ->check(CLI::Range(1, 1000));
  c.flag("--overwrite", a.overwrite, "Replace outputs that exist");
  scene_options(c, a.scene);
  c.example("brume study fog.toml shot.1001.exr -o study/report.html",
            "what each method costs on this frame, and how far off it is");
  c.example("brume study fog.toml shot.1001.exr --budget 0.5s",
            "the best settings that time allows");
  c.example("brume study fog.toml shot.1001.exr --error 1e-3",
            "the fastest settings that are good enough");
}

std::vector<CommandDoc> commands() {
  return {
      {"apply",
       "Give frames their air",
       "Reads each frame's colour and depth, lets light cross the scene's atmosphere "
       "between every pixel and the lens, and writes the frame back: all other channels "
       "and attributes as they were. A file is written whole or not at all; nothing that "
       "exists is replaced without --overwrite.",
       {},
       {}},
      {"plan",
       "Say what apply would do, and why",
       "Reads no pixels. Prints which channel is taken for depth, where the camera came "
       "from, which stages run, and which are left out for which reason.",
       {},
       {}},
      {"info",
       "Channels, depth, camera and attributes of an image",
       "Says what brume understands of a file: parts, channels and their types, which "
       "channel is the depth and what its values look like, the camera and where it came "
       "from, all attributes.",
       {},
       {}},
      {"stages",
       "The stages there are, or one stage's parameters",
       "Without a name: the stages that a scene may list. With one: its parameters.",
       {},
       {}},
      {"probe",
       "What the air does along given rays",
       "For each row of the table (world metres; the direction may have any length; the "
       "distance may be inf) prints the row and the transmittance T and the light L that "
       "the air between adds, with 9 digits. A ray is seen as a pixel of 1e-4 rad is.",
       {},
       {}},
      {"view",
       "A picture to look at",
       "Exposure, tone curve and sRGB for colour, false colour for depth and other "
       "single channels; several images come side by side.",
       {},
       {}},
      {"diff",
       "Are two images the same?",
       "Compares windows, channels, attributes and pixels of all parts, says what "
       "differs "
       "and where it differs most. Exit code: 0 the same within the limits, 1 a warning, "
       "2 they differ (or the command line makes no sense), 3 their sizes or channels "
       "differ, 4 a file cannot be read; the worst of a sequence. A NaN or infinity "
       "against anything else differs whatever the limits.",
       {},
       {}},
      {"stress",
       "Stages over stiff and extreme cases, held against laws and the truth",
       "Draws values of all parameters (ends, 0, tiny, any magnitude), eyes up to 1e7 m "
       "away and rays from no length to infinite, lamps on the ray, behind it, at the "
       "pixel, and asks of every answer: is T in 0 to 1, L no more than its source, the "
       "whole its parts, the answer the same in other units, beside other rays, on other "
       "instruction sets, whatever the order of stages, do lights add up, and what does "
       "the truth say? Stages of surfaces and lenses get frames of one pixel, of primes, "
       "of NaN and infinities, and are asked whether light is made or lost, adds up, "
       "spreads from bad pixels, depends on the tile or the camera's direction. Prints "
       "each law's worst case and the command that makes it again. Exit code 1 "
       "when a law is broken.",
       {},
       {}},
      {"study",
       "Error against run time on a frame of yours",
       "Times every way to compute the scene's air on the frame's own rays, for each "
       "stage alone and for all together: brume's along its accuracy, the method of the "
       "document an effect comes from, even steps, and volumes painted one over the "
       "other; of surface and lens stages what they do to the frame's pixels, likewise. "
       "Holds each against the truth on an even grid of pixels and wherever it is "
       "farthest off. Times are of one core, medians of repeats; reading and writing "
       "files are not in them. Exit code 1 when no settings meet --budget or --error.",
       {},
       {}},
  };
}

}  // namespace brume::cli
