#pragma once
// Tables of numbers kept on disk between runs: files in brume's cache folder, named after
// a hash of their key and holding the key itself.
//
// The folder: $BRUME_CACHE if set ("off": none is used), else $XDG_CACHE_HOME/brume, else
// $HOME/.cache/brume. Whatever is wrong with folder or file only costs the time to
// compute: a file that is short, foreign, of another key or of a wrong sum counts as
// absent. Files are written beside and renamed, so that processes that write the same one
// at once leave a whole one.

#include <span>
#include <string>
#include <vector>

namespace brume::sky {

/// The folder in use; empty: none.
std::string store_folder();

/// Fills `tables`, whose sizes say what is expected, with what is kept under `key`.
/// False, and the tables as they were, when it is not there.
bool recall(const std::string& key, std::span<std::vector<float>* const> tables) noexcept;

/// Keeps `tables` under `key`; of many files the oldest go.
void keep(const std::string& key, std::span<std::vector<float>* const> tables) noexcept;

/// The file of a key; empty without a folder.
std::string file_of(const std::string& key);

}  // namespace brume::sky
