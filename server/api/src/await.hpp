// Waits for the answer to one asynchronous call of the scheduler.
#pragma once

#include <future>
#include <memory>
#include <utility>

#include "raykiln/base/result.hpp"

namespace raykiln::server {

/// `call` gets the callback to hand on; the scheduler promises to invoke it exactly once.
template <class T, class Call>
[[nodiscard]] Result<T> await(Call call) {
  const auto promise = std::make_shared<std::promise<Result<T>>>();
  auto future = promise->get_future();
  call([promise](Result<T> result) { promise->set_value(std::move(result)); });
  return future.get();
}

}  // namespace raykiln::server
