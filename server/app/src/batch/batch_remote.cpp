// A batch on a daemon: upload what it lacks, submit, follow, fetch and judge.
#include <unistd.h>

#include <algorithm>
#include <iostream>
#include <map>

#include "../signals.hpp"
#include "batch_judge.hpp"
#include "batch_progress.hpp"
#include "batch_run.hpp"
#include "batch_scenes.hpp"
#include "raykiln/api/batch_json.hpp"
#include "raykiln/api/percent.hpp"
#include "raykiln/api/scene_json.hpp"

namespace raykiln::server {
namespace {

using std::chrono::milliseconds;
using std::chrono::steady_clock;

constexpr auto kFirstPoll = milliseconds(10), kLastPoll = milliseconds(250);
constexpr auto kPatience = std::chrono::seconds(60);  ///< with a server that does not answer
constexpr auto kFirstRetry = milliseconds(100), kLastRetry = milliseconds(2000);

class RemoteBatch {
 public:
  RemoteBatch(const BatchRun& run, BatchResult& result, Remote remote)
      : run_(run),
        wanted_(run.options.batch),
        result_(result),
        remote_(std::move(remote)),
        terminal_(isatty(STDERR_FILENO) != 0),
        progress_(std::cerr, terminal_, run.quiet),
        scenes_(result) {
    result_.server = run.options.server;
    for (std::size_t i = 0; i < result.pictures.size(); ++i) {
      by_name_[result.plan.pictures[i].name] = i;
      if (result.pictures[i].state == PictureState::kFailed) tell(i);  // its scene cannot be read
    }
  }

  ExitCode go(bool& waited) {
    result_.batch = wanted_.resume;
    if (!wanted_.resume.empty()) block_stop_signals();
    if (wanted_.resume.empty() && (!scenes_.upload(remote_) || !submit())) return remote_.failure();
    if (wanted_.rerun && !remote_.ask("POST", path() + "/rerun")) return remote_.failure();
    if (!is_to_be_waited_for()) {
      std::cout << result_.batch << std::endl;
      waited = false;
      return ExitCode::kOk;
    }
    if (result_.batch.empty()) return ExitCode::kOk;  // no picture could be sent
    if (!run_.quiet) std::cerr << "batch " << result_.batch << " at " << result_.server << "/batches/" << result_.batch << std::endl;
    const ExitCode followed = follow();
    progress_.finish();
    return followed;
  }

 private:
  [[nodiscard]] std::string path() const { return "/v1/batches/" + percent_encode(result_.batch); }
  [[nodiscard]] bool is_to_be_waited_for() const {
    return run_.options.wait || run_.options.json || !wanted_.junit.empty() || !wanted_.json.empty() || !wanted_.html.empty();
  }

  bool submit() {
    BatchRequest batch{.name = result_.plan.name, .priority = result_.plan.priority, .max_active = result_.plan.max_active,
                       .fail_fast = result_.plan.fail_fast, .reuse = result_.plan.reuse && !wanted_.no_reuse};
    for (std::size_t i = 0; i < result_.pictures.size(); ++i) {
      if (result_.pictures[i].state == PictureState::kFailed) continue;
      BatchItem item;
      item.name = result_.plan.pictures[i].name;
      item.request = result_.plan.pictures[i].request;
      item.request.scene = result_.pictures[i].scene;
      batch.items.push_back(std::move(item));
    }
    const bool failed = batch.items.size() < result_.pictures.size();
    if (batch.items.empty() || (failed && batch.fail_fast)) {
      skip_the_rest();
      return true;
    }
    ClientHeaders headers{{"Content-Type", "application/json"}};
    if (!run_.options.idempotency_key.empty()) headers.emplace_back("Idempotency-Key", run_.options.idempotency_key);
    block_stop_signals();  // waited for from here on: what the server has begun is never left without its id
    const auto answer = remote_.ask("POST", "/v1/batches", headers, batch_request_json(batch));
    const auto view = answer ? parse_batch_view(answer->body) : std::nullopt;
    if (answer && !view) remote_.fail(ExitCode::kFailure, "the server's answer is no batch");
    if (view) result_.batch = view->id;
    return view.has_value();
  }

  void skip_the_rest() {
    for (PictureResult& picture : result_.pictures) {
      if (picture.state == PictureState::kWaiting) picture.state = PictureState::kSkipped;
    }
  }

  ExitCode follow() {
    begun_ = steady_clock::now();
    auto pause = kFirstPoll;
    bool cancelling = false;
    while (true) {
      auto answer = insist("GET", path());
      if (end_ == WaitEnd::kNone) {
        const auto checked = remote_.check(std::move(answer));
        if (!checked) return remote_.failure();
        const auto view = parse_batch_view(checked->body);
        if (!view) return remote_.fail(ExitCode::kFailure, "the server's answer is no batch");
        if (const ExitCode taken = take(*view); taken != ExitCode::kOk) return taken;
        if (end_ == WaitEnd::kNone && view->state != "running") return ExitCode::kOk;
      }
      if (end_ == WaitEnd::kNone && !rest(pause)) pause = std::min(kLastPoll, pause * 3 / 2);
      if (end_ == WaitEnd::kTime) return detach("the time to wait is over");
      if (end_ == WaitEnd::kNone) continue;
      if (!wanted_.cancel_on_interrupt || cancelling) return detach("detached");
      cancelling = true;
      end_ = WaitEnd::kNone;
      if (!remote_.check(insist("POST", path() + "/cancel")) && end_ == WaitEnd::kNone) return remote_.failure();
    }
  }

  /// Waits so long; true, and `end_` says why, when that is the end of waiting.
  bool rest(milliseconds time) {
    if (stop_signal_within(time)) end_ = WaitEnd::kSignal;
    const double waited = std::chrono::duration<double>(steady_clock::now() - begun_).count();
    if (end_ == WaitEnd::kNone && wanted_.timeout_seconds > 0.0 && waited > wanted_.timeout_seconds) end_ = WaitEnd::kTime;
    return end_ != WaitEnd::kNone;
  }

  /// Asks a server that may be starting again, or stopping, until it answers, the wait ends, or patience does: then
  /// the failure is "no_server".
  Result<ClientResponse> insist(const std::string& method, const std::string& target) {
    const auto asked = steady_clock::now();
    for (auto pause = kFirstRetry;; pause = std::min(kLastRetry, 2 * pause)) {
      auto answer = HttpClient(remote_.address()).request(method, target);
      if (answer && answer->status != 503) return answer;
      if (rest(std::chrono::milliseconds(0)) || steady_clock::now() - asked >= kPatience || rest(pause)) {
        if (end_ == WaitEnd::kNone) progress_.finish();
        return Error{ErrorKind::kUnavailable, "no_server",
                     "batch " + result_.batch + " goes on when the server is back; wait for it again with --resume",
                     result_.server};
      }
    }
  }

  /// The reports say what is known by now.
  ExitCode detach(const char* why) {
    progress_.finish();
    std::cerr << "raykiln: " << why << "; the batch goes on. Wait for it again with --resume " << result_.batch << '\n';
    if (!run_.options.json) std::cout << result_.batch << std::endl;
    result_.wait_ended = true;
    return ExitCode::kOk;
  }

  /// Judges what has ended since the last look, and shows the rest.
  ExitCode take(const BatchView& view) {
    std::vector<RunningPicture> running;
    for (const BatchItemView& item : view.items) {
      const auto found = by_name_.find(item.name);
      if (found == by_name_.end() || item.state == "waiting") continue;
      if (result_.pictures[found->second].state != PictureState::kWaiting) continue;
      if (item.state == "active") {
        running.push_back({item.name, progress_of_job(running.size() < kMostBatchBars ? item.job : "")});
      } else if (const ExitCode ended = take_ended(found->second, item); ended != ExitCode::kOk || end_ != WaitEnd::kNone) {
        return ended;
      }
    }
    const auto total = result_.pictures.size();
    progress_.show(total - result_.count(PictureState::kWaiting), total, running);
    return ExitCode::kOk;
  }

  ExitCode take_ended(std::size_t index, const BatchItemView& item) {
    PictureResult& picture = result_.pictures[index];
    picture.job = item.job;
    picture.reused = item.reused;
    if (item.state == "completed") {
      if (const ExitCode judged = fetch_and_judge(index); judged != ExitCode::kOk) return judged;
    } else if (item.state == "cancelled") {
      picture.state = PictureState::kCancelled;
    } else if (item.state == "skipped") {
      picture.state = PictureState::kSkipped;
    } else {
      const std::string refusal = scenes_.refusal(picture.scene);
      fail(picture, refusal.empty() ? item.error : refusal);
    }
    if (picture.state != PictureState::kWaiting) tell(index);  // it is so still where the wait has ended
    return ExitCode::kOk;
  }

  /// An answer about the picture, or nothing: then the reason is in `picture`, the wait has ended, or `remote_` has
  /// failed and with it the batch.
  std::optional<ClientResponse> ask_for(PictureResult& picture, const std::string& target) {
    auto answer = insist("GET", target);
    if (end_ != WaitEnd::kNone) return std::nullopt;
    if (answer && (answer->status == 404 || answer->status == 500)) {
      fail(picture, problem_text(answer->body));
      return std::nullopt;
    }
    return remote_.check(std::move(answer));
  }

  ExitCode fetch_and_judge(std::size_t index) {
    const PlannedPicture& planned = result_.plan.pictures[index];
    PictureResult& picture = result_.pictures[index];
    const std::string job = "/v1/jobs/" + percent_encode(picture.job);
    const auto about = ask_for(picture, job);
    if (!about) return remote_.failure();
    const auto view = parse_job_view(about->body);
    if (!view) return remote_.fail(ExitCode::kFailure, "the server's answer is no job");
    picture.seconds = picture.reused ? 0.0 : view->render_seconds;
    picture.samples = view->samples_done;
    if (view->accuracy && view->accuracy->known()) picture.error_reached = view->accuracy->error.value;
    picture.limit_reached = planned.request.stop.error && !view->target_reached;
    if (planned.reference.empty() && wanted_.html.empty()) {
      picture.state = PictureState::kCompleted;
      return ExitCode::kOk;
    }
    const auto exr = ask_for(picture, job + "/image?format=exr");
    if (!exr) return remote_.failure();
    picture.state = PictureState::kCompleted;
    const auto judged = judge_render(result_.plan, planned, {exr->body.begin(), exr->body.end()}, run_.folder, picture);
    return judged ? ExitCode::kOk : remote_.fail(ExitCode::kFailure, judged.error().message);
  }

  [[nodiscard]] ProgressState progress_of_job(const std::string& job) const {
    ProgressState state;
    state.stage = "rendering";
    if (run_.quiet || !terminal_ || job.empty()) return state;
    const auto answer = HttpClient(remote_.address()).request("GET", "/v1/jobs/" + percent_encode(job));
    const auto view = answer && answer->status == 200 ? parse_job_view(answer->body) : std::nullopt;
    return view ? progress_of(*view) : state;
  }

  static void fail(PictureResult& picture, const std::string& why) {
    picture.state = PictureState::kFailed;
    picture.failure = why;
  }
  void tell(std::size_t index) {
    const PictureResult& picture = result_.pictures[index];
    progress_.ended(result_.plan.pictures[index].name, verdict_line(picture) + (picture.reused ? " (reused)" : ""));
  }

  const BatchRun& run_;
  const BatchOptions& wanted_;
  BatchResult& result_;
  Remote remote_;
  enum class WaitEnd { kNone, kSignal, kTime } end_ = WaitEnd::kNone;
  steady_clock::time_point begun_{};
  const bool terminal_;
  BatchProgress progress_;
  BatchScenes scenes_;
  std::map<std::string, std::size_t> by_name_;
};

}  // namespace

ExitCode run_batch_on_server(const BatchRun& run, BatchResult& result, bool& waited) {
  auto remote = Remote::open(run.options);
  if (!remote) return ExitCode::kUsage;
  return RemoteBatch(run, result, std::move(*remote)).go(waited);
}

}  // namespace raykiln::server
