# For test_recipes.sh: builds and tests a formula with the machine's own tools in the place of Homebrew's:
# build_formula.rb FORMULA VERSION PREFIX, in the sources.
require "fileutils"
require "pathname"
require "tmpdir"

def ENV.cc
  "cc"
end

class Formula
  attr_reader :version, :prefix, :testpath

  %i[desc homepage url sha256 license depends_on uses_from_macos].each { |name| define_singleton_method(name) { |*| nil } }

  def self.on_linux(&block)
    class_eval(&block)
  end

  def self.test(&block)
    define_method(:run_test, &block)
  end

  def initialize(version, prefix, testpath)
    @version = version
    @prefix = Pathname(prefix)
    @testpath = Pathname(testpath)
  end

  %i[bin include lib].each { |name| define_method(name) { prefix/name.to_s } }

  def std_meson_args
    ["--prefix=#{prefix}", "--libdir=#{lib}", "--buildtype=release", "--wrap-mode=nofallback"]
  end

  def system(*command)
    Kernel.system({"LD_LIBRARY_PATH" => lib.to_s}, *command.map(&:to_s)) || abort("failed: #{command.join(" ")}")
  end

  def shell_output(command)
    IO.popen({"LD_LIBRARY_PATH" => lib.to_s}, command, &:read)
  end

  def assert_match(part, text)
    text.include?(part) || abort("not #{part}: #{text}")
  end
end

formula, version, prefix = ARGV
require File.absolute_path(formula)
Dir.mktmpdir do |folder|
  gscl = Gscl.new(version, prefix, folder)
  gscl.install
  Dir.chdir(folder) { gscl.run_test }
end
