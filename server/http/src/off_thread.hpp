// Runs something that blocks on the handler pool and comes back to the I/O thread with its result.
#pragma once

#include <boost/asio/async_result.hpp>
#include <boost/asio/executor_work_guard.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/thread_pool.hpp>
#include <boost/asio/use_awaitable.hpp>
#include <type_traits>
#include <utility>

namespace raykiln::server {

/// `work` must not throw. The I/O context stays alive until the result is back.
template <class Work>
auto off_thread(boost::asio::thread_pool& pool, Work work) {
  using Result = std::invoke_result_t<Work&>;
  return boost::asio::async_initiate<const boost::asio::use_awaitable_t<>, void(Result)>(
      [&pool](auto handler, Work job) {
        auto guard = boost::asio::make_work_guard(handler);
        boost::asio::post(pool, [handler = std::move(handler), job = std::move(job),
                                 guard = std::move(guard)]() mutable {
          auto home = guard.get_executor();
          boost::asio::post(home, [handler = std::move(handler), result = job(),
                                   guard = std::move(guard)]() mutable {
            std::move(handler)(std::move(result));
          });
        });
      },
      boost::asio::use_awaitable, std::move(work));
}

}  // namespace raykiln::server
