// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <functional>
#include <string>
#include <vector>

#include "delfront/errors.hpp"
#include "delfront/options.hpp"
#include "pipeline/job_value.hpp"

namespace delfront {

/// @brief What an option takes; decides how a word of the command line is read.
enum class Takes : std::uint8_t {
  text,
  texts,
  length,
  number,
  count,
  boolean,
  duration,
  memory,
  keep,
  numbers,
  select
};

/// @brief One option. From the table of these come the job file's schema, the flags, the help, "did you mean",
/// `--set` and `--print-config`.
struct OptionRow {
  std::string key;  ///< path in the job file; "boundaries.*.kind" stands for one a boundary
  Takes takes = Takes::text;
  std::string flags;    ///< "--hmax,--clmax", or empty: only in the job file and by --set
  std::string metavar;  ///< in the help of the flag
  std::string help;
  std::string allowed;  ///< what the value may be, for messages
  /// Throws BadValue or UsageError with the reason only; the caller knows key and line.
  std::function<void(Options&, const JobValue&)> set;
  std::function<JobValue(const Options&)> get;  ///< kind none: not set
};

/// @brief All options, in the order in which they are printed: keys of one table stand together.
const std::vector<OptionRow>& option_table();

/// @brief One key of a table that repeats or that the user names; `set` and `get` act on one entry.
struct EntryRow {
  std::string name;
  Takes takes = Takes::text;
  std::string help, allowed;
  std::function<void(Options&, std::size_t entry, const JobValue&)> set;
  std::function<JobValue(const Options&, std::size_t entry)> get;
};

/// @brief Tables of any number: [boundaries.NAME], or [[size.source]] as a list.
struct EntryTable {
  std::string key;
  bool is_list = false;
  std::vector<EntryRow> rows;
  std::function<std::size_t(const Options&)> count;
  std::function<void(Options&)> clear;
  /// The entry of that name, made where there is none; of a list: a new one.
  std::function<std::size_t(Options&, const std::string& name)> entry_of;
  std::function<std::string(const Options&, std::size_t entry)> name_of;
  /// Where a key of an entry was set, for entries that keep that by themselves; may be empty.
  std::function<void(Options&, std::size_t entry, const std::string& name, const std::string& place)> note;
};
const std::vector<EntryTable>& entry_tables();

/// @brief A flag that stands for one or more keys: --farfield sphere:20c, --no-improve.
struct Shorthand {
  std::string flags, metavar, help;
  bool takes_value = true;
  std::function<void(Options&, const std::string&)> apply;  ///< throws UsageError
};
const std::vector<Shorthand>& shorthand_table();

/// @brief A word of the command line as the value of a row: text for rows of text, else as TOML reads it.
/// @throws UsageError  a table or list that is not TOML
JobValue value_from_text(Takes takes, const std::string& text);

/// @brief Put a value, a whole table or an entry of it, into the options.
/// @param path   "" for the whole job file, "size", "size.hmax", …
/// @param where  what stands before a message for a value of the given line, e.g. "case.toml:12: "
/// @throws UsageError  unknown key, wrong type or value
void apply_value(Options& options, const std::string& path, const JobValue& value,
                 const std::function<std::string(int line)>& where);

/// @return "case.toml:12: ", "--hmax: ", or nothing where it is not known where the key was set
std::string place_of_key(const Options& options, const std::string& key);

/// @brief For what shows only when all options are known: where the key was set, the key, the message.
UsageError usage_error(const Options& options, const std::string& key, const std::string& message);

/// @brief Does some work; what it is refused for is said with the key and the place where that was set.
template <class Work>
auto with_place(const Options& options, const std::string& key, const Work& work) {
  try {
    return work();
  } catch (const UsageError& e) {
    throw usage_error(options, key, e.what());
  } catch (const InputError& e) {
    throw InputError(usage_error(options, key, e.what()).what(), e.places);
  } catch (const IoError& e) {
    throw IoError(place_of_key(options, key) + e.what());
  }
}

/// @return all effective options as the job file's tree; what is not set is left out
JobValue option_tree(const Options& options);

/// @return " (did you mean 'x'?)" or nothing
std::string did_you_mean(const std::string& typed, const std::vector<std::string>& names);

/// @return ": not in this version of delfront" for keys and flags that a later version will know, else nothing
std::string planned_note(const std::string& key_or_flag);

}  // namespace delfront
