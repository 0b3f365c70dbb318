#pragma once
// What stands in page.css and page.js, put here by the build. Internal to src/study.

namespace brume::study {

extern const char* const kPageStyle;
extern const char* const kPageScript;

}  // namespace brume::study
