#!/usr/bin/env python3
"""Makes the C interface's declarations for C# (P/Invoke) from its header.

usage: generate.py palpate.h Palpate.cs
"""

import itertools
import re
import sys

NUMBERS = {"int32_t": "int", "uint32_t": "uint", "int64_t": "long", "uint64_t": "ulong", "double": "double",
           "float": "float", "size_t": "UIntPtr", "palpate_status": "Status"}
VECTORS = {("double", "3"): "Vector", ("double", "4"): "Quaternion", ("double", "9"): "Matrix",
           ("int32_t", "3"): "Index3"}
UTF8 = "[MarshalAs(UnmanagedType.LPUTF8Str)] "
SAMPLES = ("IntPtr", "byte[]", "short[]", "ushort[]", "float[]")

HEAD = """// Generated from palpate.h, which says what each function does: P/Invoke declarations for .NET, Mono and
// Unity. Texts are UTF-8. Where a pointer to a struct may be null, an overload takes IntPtr.Zero. Keep
// delegates that are given to the library in a field, so that they are not collected while it may call them. An
// exception that leaves a delegate ends the program: catch it there.
using System;
using System.Runtime.InteropServices;
using System.Text;

namespace PalpateC
{
    public class PalpateException : Exception
    {
        public readonly Status Status;
        public PalpateException(Status status, string message) : base(message) { Status = status; }
    }

    [StructLayout(LayoutKind.Sequential)]
    public struct Index3
    {
        public int X, Y, Z;
        public Index3(int x, int y, int z) { X = x; Y = y; Z = z; }
    }

    [StructLayout(LayoutKind.Sequential)]
    public struct Vector
    {
        public double X, Y, Z;
        public Vector(double x, double y, double z) { X = x; Y = y; Z = z; }
        public double Length { get { return Math.Sqrt(X * X + Y * Y + Z * Z); } }
    }

    [StructLayout(LayoutKind.Sequential)]
    public struct Quaternion
    {
        public double X, Y, Z, W;
    }

    [StructLayout(LayoutKind.Sequential)]
    public struct Matrix
    {
        public Vector Row0, Row1, Row2;
    }

    /// A struct in memory of its own, for members that point to one; Dispose after the call.
    public sealed class Unmanaged<T> : IDisposable where T : struct
    {
        public readonly IntPtr Pointer;
        public Unmanaged(T value)
        {
            Pointer = Marshal.AllocHGlobal(Marshal.SizeOf(typeof(T)));
            Marshal.StructureToPtr(value, Pointer, false);
        }
        public void Dispose()
        {
            Marshal.DestroyStructure(Pointer, typeof(T));
            Marshal.FreeHGlobal(Pointer);
        }
    }
"""

TAIL = """
        /// Of the library's texts.
        public static string Text(IntPtr text)
        {
            if (text == IntPtr.Zero) return null;
            int length = 0;
            while (Marshal.ReadByte(text, length) != 0) ++length;
            var bytes = new byte[length];
            Marshal.Copy(text, bytes, 0, length);
            return Encoding.UTF8.GetString(bytes);
        }

        public static string LastError { get { return Text(palpate_last_error()); } }

        /// One of Constants.TextProblem, TextPrivileges and TextDevice.
        public static string RunText(IntPtr run, int which)
        {
            var needed = (UIntPtr)256;
            byte[] buffer;
            do  // the text may have become longer meanwhile
            {
                buffer = new byte[(int)needed];
                Check(palpate_run_text(run, which, buffer, (UIntPtr)buffer.Length, out needed));
            }
            while ((int)needed > buffer.Length);
            return Encoding.UTF8.GetString(buffer, 0, (int)needed - 1);
        }

        public static string Version { get { return Text(palpate_version()); } }

        /// Throws for every other status.
        public static void Check(Status status)
        {
            if (status != Status.Ok) throw new PalpateException(status, LastError);
        }

        public static uint SizeOf<T>() where T : struct { return (uint)Marshal.SizeOf(typeof(T)); }
    }
}
"""


def pascal(name):
    return "".join(part.capitalize() for part in re.sub(r"^palpate_", "", name.lower()).split("_"))


class Header:
    def __init__(self, text):
        text = re.sub(r"/\*.*?\*/", "", text, flags=re.DOTALL)
        self.status = re.search(r"typedef enum palpate_status \{(.*?)\}", text, re.DOTALL).group(1)
        self.constants = re.findall(r"^ *PALPATE_(\w+) = (\d+)", "\n".join(
            re.sub(r", *", ",\n", body) for body in re.findall(r"^enum \{(.*?)\};", text, re.DOTALL | re.MULTILINE)),
            re.MULTILINE)
        self.structs = {name: " ".join(body.split()) for name, body in re.findall(
            r"typedef struct (\w+) \{(.*?)\} \1;", text, re.DOTALL)}
        self.functions = [(" ".join(result.split()), name, " ".join(arguments.split())) for result, name, arguments in
                          re.findall(r"^PALPATE_API ([^;(]*?)\b(palpate_\w+)\((.*?)\);", text, re.DOTALL | re.MULTILINE)]
        # Structs that the library fills in: their texts stay its own.
        self.filled = {name for name in self.structs if any(
            re.search(rf"(?<!const ){name} \*", arguments) for _, _, arguments in self.functions)}
        self.delegates = []

    def delegate(self, name, result, arguments):
        parameters = ", ".join(self.parameter("", one)[0] for one in arguments.split(", "))
        self.delegates.append(f"    [UnmanagedFunctionPointer(CallingConvention.Cdecl)]\n"
                              f"    public delegate {NUMBERS.get(result, result)} {name}({parameters});\n")
        return name

    def members(self, struct):
        """Lines of a C# struct."""
        for member in filter(None, (one.strip() for one in self.structs[struct].split(";"))):
            pointer = re.fullmatch(r"(\w+) \(\*(\w+)\)\((.*)\)", member)
            if pointer:
                result, name, arguments = pointer.groups()
                yield f"{self.delegate(pascal(struct) + pascal(name), result, arguments)} {pascal(name)};"
                continue
            kind, names = re.fullmatch(r"((?:const )?\w+) (.*)", member).groups()
            for name in names.split(", "):
                text = kind == "const char" and struct not in self.filled
                array = re.fullmatch(r"(\w+)\[(\d)\]", name)
                if array:
                    yield f"{VECTORS[kind, array.group(2)]} {pascal(array.group(1))};"
                elif text:
                    yield f"{UTF8}public string {pascal(name[1:])};"
                elif name.startswith("*"):
                    yield f"IntPtr {pascal(name[1:])};"
                else:
                    yield f"{NUMBERS.get(kind) or pascal(kind)} {pascal(name)};"

    def parameter(self, function, text):
        """The ways in which C# gives a parameter."""
        pointer = re.fullmatch(r"(\w+) \(\*(\w+)\)\((.*)\)", text)
        if pointer:
            result, name, arguments = pointer.groups()
            return [f"{self.delegate(pascal(function) + pascal(name), result, arguments)} {name}"]
        handles = re.fullmatch(r"\w+ \*const \*(\w+)", text)
        if handles:
            return [f"IntPtr[] {handles.group(1)}"]
        constant, kind, stars, name, array = re.fullmatch(
            r"(const )?(\w+) (\**)(\w+)(\[\d\])?", text).groups()
        name = "@" + name if name in ("out", "object") else name
        if array:
            return [f"ref {VECTORS[kind, array[1:-1]]} {name}"]
        if not stars:
            return [f"{NUMBERS[kind]} {name}"]
        if stars == "**":
            return [f"out IntPtr {name}"]
        if kind in self.structs:
            return [f"ref {pascal(kind)} {name}"] + ([f"IntPtr {name}"] if constant and function else [])
        if kind == "char":
            return [f"{UTF8}string {name}" if constant else f"[Out] byte[] {name}"]
        if kind == "void" and name == "samples":
            return [f"{way} {name}" for way in (SAMPLES if function.endswith("_copy") else SAMPLES[:1])]
        if kind not in NUMBERS:
            return [f"IntPtr {name}"]  # a handle, or a context
        if name in ("done", "ticks", "needed", "value"):
            return [f"out {NUMBERS[kind]} {name}"]
        return [f"{'' if constant else '[Out] '}{NUMBERS[kind]}[] {name}"]

    def function(self, result, name, arguments):
        kind = "IntPtr" if "*" in result else NUMBERS.get(result, result)
        ways = [] if arguments == "void" else [self.parameter(name, one) for one in self.split(arguments)]
        for way in itertools.product(*ways):
            yield f"        [DllImport(Library)] public static extern {kind} {name}({', '.join(way)});\n"

    @staticmethod
    def split(arguments):
        """At commas outside of parentheses."""
        return re.split(r", (?![^()]*\)(?!\())", arguments)


def declarations(text):
    header = Header(text)
    names = re.findall(r"PALPATE_(\w+) = (\d+)", header.status)
    parts = ["\n    public enum Status\n    {\n"]
    parts += [f"        {pascal(name)} = {number},\n" for name, number in names] + ["    }\n"]
    parts += ["\n    public static class Constants\n    {\n        public const int "]
    parts += [",\n            ".join(f"{pascal(name)} = {number}" for name, number in header.constants), ";\n    }\n"]
    for struct in header.structs:
        lines = [line if line.startswith("[") else f"public {line}" for line in header.members(struct)]
        parts += [f"\n    [StructLayout(LayoutKind.Sequential)]\n    public struct {pascal(struct)}\n    {{\n"]
        parts += [f"        {line}\n" for line in lines] + ["    }\n"]
    functions = [line for one in header.functions for line in header.function(*one)]
    parts += ["\n", *header.delegates, "\n    public static class Native\n    {\n",
              "        const string Library = \"palpate-c\";\n\n", *functions]
    return HEAD + "".join(parts) + TAIL


if __name__ == "__main__":
    if len(sys.argv) != 3:
        sys.exit(__doc__.strip())
    with open(sys.argv[1], encoding="utf-8") as source:
        made = declarations(source.read())
    with open(sys.argv[2], "w", encoding="utf-8") as target:
        target.write(made)
