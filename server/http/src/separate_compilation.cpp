// The bodies of Asio and Beast, compiled here and nowhere else (BOOST_ASIO_SEPARATE_COMPILATION and
// BOOST_BEAST_SEPARATE_COMPILATION are set for all who use them).
#include <boost/asio/impl/src.hpp>
#include <boost/beast/src.hpp>
