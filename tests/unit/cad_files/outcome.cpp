// SPDX-License-Identifier: Apache-2.0
#include "outcome.hpp"

#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <cstring>
#include <new>
#include <set>
#include <sstream>

#include "delfront/cad.hpp"
#include "delfront/surface_check.hpp"
#include "delfront/uniform_size.hpp"

namespace delfront::fixtures {
namespace {

using Way = Outcome::Way;

/// Written by the child at once, line by line: way, then facts.
class Teller {
 public:
  explicit Teller(int pipe) : pipe_(pipe) {}
  template <class Value>
  void tell(const char* key, const Value& value) const {
    std::ostringstream line;
    line << key << ' ' << value;
    std::string text = line.str();
    for (char& c : text)
      if (c == '\n') c = ' ';
    text += '\n';
    if (write(pipe_, text.data(), text.size()) < 0) _exit(1);
  }

 private:
  int pipe_;
};

void tell_notes(const CadReport& cad, const Teller& out) {
  std::set<std::string> kinds;
  for (const auto& list : {cad.repairs, cad.suspicious})
    for (const CadNote& note : list) kinds.insert(note.kind);
  std::string notes = " ";
  for (const std::string& kind : kinds) notes += kind + ' ';
  out.tell("notes", notes);
  out.tell("num_notes", cad.repairs.size() + cad.suspicious.size());
  out.tell("free_edges", cad.free_edges);
}

void work(const std::string& path, bool grids, const Teller& out) {
  Context context;
  context.on_log = [&](LogLevel, const std::string& message) {
    if (message.starts_with(kCadReadingBegins)) out.tell("reading", 1);
    if (message.starts_with(kCadReadingEnds)) out.tell("reading", 0);
  };
  CadReport cad;
  const Brep brep = read_cad(path, {}, cad, context);
  tell_notes(cad, out);
  out.tell("faces", brep.faces.size());
  if (!grids) return;
  Box box;
  for (const BrepCorner& corner : brep.corners) box.add(corner.at);
  BrepGridReport report;
  const double size = box.diagonal() > 0 ? box.diagonal() / 20 : 1;
  const SurfaceReport facts = check_surface(grid_brep(brep, UniformSize(size), {}, report, context), context);
  out.tell("is_closed", facts.is_closed);
  out.tell("area", facts.area);
  out.tell("volume", facts.volume);
}

void work_and_catch(const std::string& path, bool grids, const Teller& out) {
  const auto fail = [&](Way way, const Error& e) {
    out.tell("message", e.what());
    out.tell("has_place", !e.places.empty());
    out.tell("way", int(way));
  };
  try {
    work(path, grids, out);
    out.tell("way", int(Way::gridded));
  } catch (const InputError& e) {
    fail(Way::input_error, e);
  } catch (const MeshingError& e) {
    fail(Way::meshing_error, e);
  } catch (const Error& e) {
    fail(Way::other_error, e);
  } catch (const std::bad_alloc&) {
    out.tell("message", "out of memory");
    out.tell("way", int(Way::other_error));
  }
}

void take(const std::string& line, Outcome& result, bool& is_reading) {
  std::istringstream in(line);
  std::string key;
  in >> key;
  const auto rest = [&] { return line.substr(std::min(line.size(), key.size() + 1)); };
  int number = 0;
  if (key == "way") in >> number, result.way = Way(number);
  if (key == "reading") in >> is_reading;
  if (key == "message") result.message = rest();
  if (key == "notes") result.notes = rest();
  if (key == "num_notes") in >> result.num_notes;
  if (key == "free_edges") in >> result.free_edges;
  if (key == "faces") in >> result.faces;
  if (key == "is_closed") in >> result.is_closed;
  if (key == "has_place") in >> result.has_place;
  if (key == "area") in >> result.area;
  if (key == "volume") in >> result.volume;
}

}  // namespace

Outcome find_outcome(const std::string& path, unsigned seconds, bool grids) {
  int ends[2];
  if (pipe(ends) != 0) throw std::bad_alloc();
  const auto start = std::chrono::steady_clock::now();
  const pid_t child = fork();
  if (child == 0) {
    close(ends[0]);
    const rlimit cpu = {seconds, seconds + 1}, core = {0, 0};
    setrlimit(RLIMIT_CPU, &cpu);
    setrlimit(RLIMIT_CORE, &core);
    work_and_catch(path, grids, Teller(ends[1]));
    _exit(0);
  }
  close(ends[1]);
  Outcome result;
  std::string text, line;
  char buffer[4096];
  for (ssize_t n; (n = read(ends[0], buffer, sizeof buffer)) > 0;) text.append(buffer, std::size_t(n));
  close(ends[0]);
  int status = 0;
  waitpid(child, &status, 0);
  bool is_reading = false;
  for (std::istringstream lines(text); std::getline(lines, line);) take(line, result, is_reading);
  if (WIFSIGNALED(status)) {
    result.way = is_reading ? Way::crashed_reading : Way::crashed;
    result.message = strsignal(WTERMSIG(status));
    if (WTERMSIG(status) == SIGXCPU || WTERMSIG(status) == SIGKILL) result.way = Way::endless;
  }
  result.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return result;
}

std::string name_of(Way way) {
  constexpr const char* kNames[] = {"gridded",         "input_error", "meshing_error", "other_error",
                                    "crashed_reading", "crashed",     "endless"};
  return kNames[int(way)];
}

}  // namespace delfront::fixtures
