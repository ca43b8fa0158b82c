#include "accuracy_record.hpp"

#include <algorithm>
#include <charconv>

namespace raykiln::server {
namespace {

std::vector<double> reals(const std::vector<std::string>& list) {
  std::vector<double> values(list.size());
  for (std::size_t i = 0; i < list.size(); ++i) {
    std::from_chars(list[i].data(), list[i].data() + list[i].size(), values[i]);
  }
  return values;
}

void write_figure(RecordWriter& r, const char* key, const ErrorFigure& figure) {
  for (const double value : {figure.value, figure.low, figure.high}) r.real(key, value);
}

ErrorFigure read_figure(const RecordReader& r, const char* key) {
  auto values = reals(r.list(key));
  values.resize(3);
  return {values[0], values[1], values[2]};
}

/// One list of so many numbers a point: older versions of a point would have fewer.
constexpr std::size_t kPointNumbers = 7;

void write_curve(RecordWriter& r, const std::vector<CurvePoint>& curve) {
  for (const CurvePoint& p : curve) {
    for (const double value : {p.render_seconds, p.worker_seconds, p.samples,
                               static_cast<double>(p.rays), p.error.value, p.error.low, p.error.high}) {
      r.real("curve", value);
    }
  }
}

std::vector<CurvePoint> read_curve(const RecordReader& r) {
  const auto v = reals(r.list("curve"));
  std::vector<CurvePoint> curve;
  for (std::size_t i = 0; i + kPointNumbers <= v.size() && curve.size() < kMostCurvePoints; i += kPointNumbers) {
    curve.push_back({.render_seconds = v[i],
                     .worker_seconds = v[i + 1],
                     .samples = v[i + 2],
                     .rays = static_cast<std::uint64_t>(std::max(0.0, v[i + 3])),
                     .error = {v[i + 4], v[i + 5], v[i + 6]}});
  }
  return curve;
}

/// Six numbers a forecast; the last is 0 while its error is not reached.
constexpr std::size_t kForecastNumbers = 6;

void write_forecasts(RecordWriter& r, const std::vector<Forecast>& forecasts) {
  for (const Forecast& f : forecasts) {
    for (const double value : {f.made_at, f.error, f.seconds.value, f.seconds.low, f.seconds.high,
                               f.actual.value_or(0.0)}) {
      r.real("forecast", value);
    }
  }
}

std::vector<Forecast> read_forecasts(const RecordReader& r) {
  const auto v = reals(r.list("forecast"));
  std::vector<Forecast> forecasts;
  for (std::size_t i = 0; i + kForecastNumbers <= v.size() && forecasts.size() < kMostForecasts;
       i += kForecastNumbers) {
    forecasts.push_back({.made_at = v[i], .error = v[i + 1], .seconds = {v[i + 2], v[i + 3], v[i + 4]}});
    if (v[i + 5] > 0.0) forecasts.back().actual = v[i + 5];
  }
  return forecasts;
}

}  // namespace

std::vector<std::uint64_t> naturals(const std::vector<std::string>& list) {
  std::vector<std::uint64_t> values(list.size());
  for (std::size_t i = 0; i < list.size(); ++i) {
    std::from_chars(list[i].data(), list[i].data() + list[i].size(), values[i]);
  }
  return values;
}

void write_accuracy(RecordWriter& r, const JobSnapshot& job) {
  r.text("done_by", name(job.done_by));
  write_curve(r, job.curve);
  write_forecasts(r, job.forecasts);
  for (const std::uint64_t samples : job.tile_samples) r.natural("tile_samples", samples);
  if (!job.continues.empty()) r.text("continues", job.continues);
  r.real("continued_samples", job.continued_samples);
  if (!job.accuracy) return;
  const PictureError& a = *job.accuracy;
  r.text("accuracy.grade", a.grade);
  write_figure(r, "accuracy.error", a.error);
  write_figure(r, "accuracy.rmse", a.rmse);
  write_figure(r, "accuracy.display_rmse", a.display_rmse);
  r.integer("accuracy.heavy_tailed", a.heavy_tailed ? 1 : 0);
  for (const std::string& notice : a.notices) r.text("accuracy.notice", notice);
  r.natural("accuracy.least_samples", a.least_samples);
  r.real("accuracy.mean_samples", a.mean_samples);
}

void read_accuracy(const RecordReader& r, JobSnapshot& job) {
  job.done_by = done_by_named(r.text("done_by"));
  job.curve = read_curve(r);
  job.forecasts = read_forecasts(r);
  job.tile_samples = naturals(r.list("tile_samples"));
  job.continues = r.text("continues");
  job.continued_samples = r.real("continued_samples");
  if (!r.has("accuracy.grade")) return;
  PictureError& a = job.accuracy.emplace();
  a.grade = r.text("accuracy.grade");
  a.error = read_figure(r, "accuracy.error");
  a.rmse = read_figure(r, "accuracy.rmse");
  a.display_rmse = read_figure(r, "accuracy.display_rmse");
  a.heavy_tailed = r.integer("accuracy.heavy_tailed") != 0;
  a.notices = r.list("accuracy.notice");
  a.least_samples = r.natural("accuracy.least_samples");
  a.mean_samples = r.real("accuracy.mean_samples");
}

}  // namespace raykiln::server
