#pragma once
// One Session::prepare, step by step. Internal to src/pipeline.

#include <memory>
#include <string>

#include "pipeline/impl.h"
#include "pipeline/inputs.h"
#include "pipeline/knobs.h"
#include "stage/registry.h"

namespace brume {

/// One prepare: the steps share these.
class Preparation {
 public:
  Preparation(const SceneFile& scene, Registry& registry, StageCache& cache,
              const FrameSource& source)
      : scene_(scene),
        registry_(registry),
        cache_(cache),
        source_(source),
        f_(std::make_unique<PreparedFrame::Impl>()),
        list_(source, f_->inputs),
        input_(SceneFile::section<InputSection>(scene.input, source.frame)),
        output_(SceneFile::section<OutputSection>(scene.output, source.frame)) {
    f_->plan.frame = source.frame;
  }

  std::unique_ptr<PreparedFrame::Impl> run() {
    find_camera();
    describe_frame();
    create_stages();
    order_stages();
    publish();
    leave_out_unlit();
    choose_inputs();
    compile_air();
    choose_outputs();
    choose_one_pass();
    find_extent();
    note_losses();
    summarise();
    return std::move(f_);
  }

 private:
  void decide(std::string text) { f_->plan.decisions.push_back(std::move(text)); }

  void find_camera();
  void describe_frame();
  void create_stages();
  std::string left_out(const StageEntry&) const;
  RunningStage make(const StageEntry&);
  FrameInfo told(const RunningStage&) const;
  void order_stages();
  const std::string& name_of(const RunningStage& s) const {
    return f_->plan.stages[std::size_t(s.plan)].name;
  }

  // prepare_inputs.cpp
  void choose_inputs();
  void choose_depth();

  void publish();
  void leave_out_unlit();
  void compile_air();
  void report_knobs();

  // prepare_outputs.cpp
  int add_output(const std::string& name, PixelType type);
  OutputRgb add_layer(const std::string& name);
  void choose_outputs();
  void add_aov(const std::string& aov);
  void choose_one_pass();
  void find_extent();
  void note_losses();
  void summarise();

  const SceneFile& scene_;
  Registry& registry_;
  StageCache& cache_;
  const FrameSource& source_;
  std::unique_ptr<PreparedFrame::Impl> f_;
  InputList list_;
  InputSection input_;
  OutputSection output_;
  FrameInfo info_;
  Knobs knobs_;
};

}  // namespace brume
