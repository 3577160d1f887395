// SPDX-License-Identifier: Apache-2.0
// delfront view: a grid, a surface or a running job in the browser, or as one file for others to open.
#include <fmt/format.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>

#include "commands.hpp"
#include "delfront/errors.hpp"
#include "delfront/io.hpp"
#include "guard.hpp"
#include "pipeline/inspect.hpp"
#include "pipeline/report_json.hpp"
#include "view/job_progress.hpp"
#include "view/page.hpp"
#include "view/page_data.hpp"
#include "view/page_server.hpp"

namespace delfront::cli {

namespace {

/// The user's browser, where there is a screen for it; whether it came is the user's to see.
bool open_browser(const std::string& url) {
  if (!std::getenv("DISPLAY") && !std::getenv("WAYLAND_DISPLAY")) return false;
  const pid_t child = fork();
  if (child < 0) return false;
  if (child == 0) {
    setsid();  // Ctrl-C here is not for the browser
    if (fork() == 0) {
      if (!std::freopen("/dev/null", "w", stdout) || !std::freopen("/dev/null", "w", stderr)) _exit(1);
      execlp("xdg-open", "xdg-open", url.c_str(), static_cast<char*>(nullptr));
    }
    _exit(0);
  }
  waitpid(child, nullptr, 0);
  return true;
}

class ViewCommand : public Command {
 public:
  explicit ViewCommand(CLI::App& parent) {
    app = parent.add_subcommand("view", "Look at a grid, a surface or a running job in the browser");
    app->allow_extras();
    app->footer(
        "The page is served on this machine only, under an address that no one can guess, until Ctrl-C. An exported\n"
        "file needs neither server nor network. Keys: ? on the page.\n"
        "Examples:\n"
        "  delfront view body.vtu\n"
        "  delfront view body.stl defects.vtp          with what 'delfront check --defects' found\n"
        "  delfront view body.vtu --export body.html\n"
        "  delfront mesh body.stl -o body.vtu --progress json 2>run.jsonl &\n"
        "  delfront view body.vtu --job run.jsonl      its progress, then the grid");
    app->add_option("FILE", file_, "grid, surface, CAD file, or folder of an OpenFOAM case");
    app->add_option("DEFECTS,--defects", defects_, "file of defects to show with it (.vtp)")->type_name("FILE");
    app->add_option("--export", export_, "write a page with everything in it, instead of serving")->type_name("FILE");
    app->add_option("--job", job_, "what a job writes with --progress json; - for stdin")->type_name("FILE");
    app->add_option("--port", port_, "port to serve on; by default any free one")
        ->type_name("N")
        ->check(CLI::Range(0, 65535));
    app->add_flag("--no-browser", has_no_browser_, "do not open a browser");
    app->add_option("--format", format_, "type of FILE, instead of by extension")->type_name("FORMAT");
    add_common_flags();
  }

  int run(const std::string&) override {
    Terminal terminal = make_terminal();
    page_or_throw();
    check_arguments();
    if (needs_guard(file_, format_))
      if (const std::optional<int> ended = go_on_in_child(terminal)) return *ended;
    Context context;
    prepare(context, terminal);
    if (!export_.empty()) return write_page(terminal, context);
    serve(terminal, context);
    return static_cast<int>(ExitCode::done);
  }

 private:
  void check_arguments() const {
    if (file_.empty() && job_.empty())
      throw UsageError("delfront view needs a FILE or --job; see delfront view --help");
    if (!export_.empty() && !job_.empty())
      throw UsageError("--export writes what is there, --job shows what is going on; leave one of them out");
    if (export_.empty()) return;
    check_writable(export_);
    std::error_code ignored;
    for (const std::string& input : {file_, defects_})
      if (std::filesystem::is_regular_file(export_, ignored) && std::filesystem::equivalent(export_, input, ignored))
        throw UsageError(export_ + " is an input and would be overwritten; give the page another name");
  }

  std::string make_data(bool is_compact, Context& context) const {
    const Inspected it = inspect_file(file_, format_, context);
    std::vector<Finding> findings = it.findings;
    if (it.mesh->blocks.empty() && !findings.empty()) throw InputError(findings[0].message, findings[0].places);
    if (!defects_.empty()) findings = read_defects(defects_, context);
    const std::filesystem::path path(file_);
    const std::string name = (path.has_filename() ? path : path.parent_path()).filename().string();
    return make_page_data({name, it.mesh.get(), it.is_grid, std::move(findings)}, is_compact, context);
  }

  int write_page(Terminal& terminal, Context& context) const {
    const std::string page = make_export(page_or_throw(), make_data(true, context));
    write_text_file(export_, page);
    terminal.clear_bar();
    if (terminal.verbosity() >= 0)
      fmt::print("written        {} ({:.1f} MB)\n", export_, static_cast<double>(page.size()) / 1e6);
    return static_cast<int>(ExitCode::done);
  }

  /// Whether FILE has come, or another one has taken its place.
  bool is_new() {
    std::error_code error;
    if (file_.empty()) return false;
    const auto written = std::filesystem::last_write_time(file_, error);
    if (error || written == written_) return false;
    written_ = written;
    return true;
  }

  void load(Served& served, Context& context) const {
    served.grid = std::make_shared<const std::string>(make_data(false, context));
  }

  /// With a job FILE need not be there yet: it appears whole, when the job is done.
  void serve(Terminal& terminal, Context& context) {
    Served served;
    served.token = make_token();
    served.page = page_or_throw();
    std::optional<JobProgress> job;
    if (!job_.empty()) job.emplace(job_);
    if (!job) load(served, context);
    terminal.clear_bar();
    LocalServer server(port_, [&](const Request& request) { return answer_request(served, request); });
    served.port = server.port();
    const std::string url = fmt::format("http://127.0.0.1:{}/{}/", served.port, served.token);
    fmt::print("{}\n", url);
    std::fflush(stdout);
    if (!has_no_browser_) open_browser(url);
    if (terminal.verbosity() >= 0) terminal.log(LogLevel::info, "serving until Ctrl-C");
    server.run(*context.cancel, [&] {
      if (!job) return;
      job->update();
      if (is_new()) load_of_job(served, terminal, context);
      nlohmann::ordered_json state = job->state();
      state["grids"] = num_grids_;
      served.progress = std::make_shared<const std::string>(
          state.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace));
    });
  }

  /// A grid that cannot be read ends no view of its job.
  void load_of_job(Served& served, Terminal& terminal, Context& context) {
    try {
      load(served, context);
      ++num_grids_;
    } catch (const Cancelled&) {
    } catch (const Error& e) {
      terminal.error(e.exit_code, e.what(), e.places);
    }
    terminal.clear_bar();
  }

  std::string file_, defects_, export_, job_, format_;
  int port_ = 0, num_grids_ = 0;
  bool has_no_browser_ = false;
  std::filesystem::file_time_type written_{};  ///< the FILE that was loaded last
};

}  // namespace

std::unique_ptr<Command> make_view_command(CLI::App& app) { return std::make_unique<ViewCommand>(app); }

}  // namespace delfront::cli
