// SPDX-License-Identifier: Apache-2.0
// The one symbol that is seen. No exception leaves: what went wrong stands in the result.
#include <Message.hxx>
#include <Message_Messenger.hxx>
#include <Message_Printer.hxx>
#include <Standard_Failure.hxx>
#include <Standard_OutOfMemory.hxx>
#include <Standard_Version.hxx>
#include <mutex>
#include <new>

#include "fmt/format.h"
#include "translation.hpp"

namespace delfront::cad {
namespace {

std::mutex one_at_a_time;  // OpenCASCADE keeps units and messages in globals

/// The library prints nothing; the printers come back afterwards.
class Silence {
 public:
  Silence() {
    const Message_SequenceOfPrinters& all = Message::DefaultMessenger()->Printers();
    for (int i = 1; i <= all.Length(); ++i) printers_.Append(all.Value(i));
    for (int i = 1; i <= printers_.Length(); ++i) Message::DefaultMessenger()->RemovePrinter(printers_.Value(i));
  }
  ~Silence() {
    for (int i = 1; i <= printers_.Length(); ++i) Message::DefaultMessenger()->AddPrinter(printers_.Value(i));
  }
  Silence(const Silence&) = delete;
  Silence& operator=(const Silence&) = delete;

 private:
  Message_SequenceOfPrinters printers_;
};

constexpr const char* kNoMemory =
    "reading it takes more memory than there is; a number in the file that counts something is probably damaged: "
    "export "
    "it again, or part by part";

void work(const Request& request, Result& result) {
  const Say say = [&](const char* what, double fraction) {
    if (request.progress && !request.progress(request.user, what, fraction)) throw Stopped();
  };
  say("reading", -1);
  Part part = read_file(request.path, say);
  heal(part, request.options, say);
  Translation data = request.options.imprints ? join(part, say) : translate(part, say);
  finish(part, std::move(data), result);
}

Result* read(const Request* request) {
  auto result = std::make_unique<Result>();
  const std::lock_guard lock(one_at_a_time);
  const Silence silence;
  try {
    work(*request, *result);
    result->ending = Result::Ending::done;
  } catch (const Stopped&) {
    result->ending = Result::Ending::stopped;
  } catch (const Failure& e) {
    result->error = e.what();
  } catch (const std::bad_alloc&) {
    result->error = kNoMemory;
  } catch (const Standard_OutOfMemory&) {
    result->error = kNoMemory;
  } catch (const Standard_Failure& e) {
    result->error = fmt::format("OpenCASCADE could not read it: {} {}", e.DynamicType()->Name(),
                                e.GetMessageString() ? e.GetMessageString() : "");
  } catch (const std::exception& e) {
    result->error = e.what();
  }
  return result.release();
}

void release(Result* result) { delete result; }

constexpr ModuleInfo kInfo{kInterfaceVersion,
                           sizeof(Request),
                           sizeof(Result),
                           sizeof(Face),
                           "OpenCASCADE " OCC_VERSION_COMPLETE,
                           read,
                           release};

}  // namespace
}  // namespace delfront::cad

extern "C" __attribute__((visibility("default"))) const delfront::cad::ModuleInfo* delfront_cad_module() {
  return &delfront::cad::kInfo;
}
