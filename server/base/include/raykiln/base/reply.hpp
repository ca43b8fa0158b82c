// The answer to one asynchronous call.
#pragma once

#include <functional>
#include <new>
#include <utility>

#include "raykiln/base/result.hpp"

namespace raykiln::server {

/// Invoked exactly once, on a thread of who was asked, never under a lock: it must only post.
template <class T>
using Reply = std::function<void(Result<T>)>;

[[nodiscard]] inline Error shutting_down() {
  return {ErrorKind::kUnavailable, "shutting_down", "the server is stopping", "", 5};
}

/// Has `post` run `step(reply)`; answers itself where nothing is taken any more (`post` gives false), or
/// memory is short.
template <class T, class Post, class Step>
void answer_by(const Post& post, const Reply<T>& reply, Step step) {
  const bool posted = post([reply, step = std::move(step)]() mutable {
    try {
      step(reply);
    } catch (const std::bad_alloc&) {
      reply(Error{ErrorKind::kInternal, "internal", "out of memory", ""});
    }
  });
  if (!posted) reply(shutting_down());
}

}  // namespace raykiln::server
