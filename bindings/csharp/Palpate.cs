// The C interface (palpate.h) for C#: declarations for P/Invoke as .NET, Mono and Unity take them.
// palpate.h says what each function does. Keep delegates that are given to the library in a field, so
// that they are not collected while it may call them.
using System;
using System.Runtime.InteropServices;

namespace PalpateC
{
    public enum Status
    {
        Ok, Invalid, Input, Output, NoDevice, QueueFull, WrongState, NothingYet, NoMemory, System,
        Cancelled, Internal
    }

    public class PalpateException : Exception
    {
        public readonly Status Status;
        public PalpateException(Status status, string message) : base(message) { Status = status; }
    }

    [StructLayout(LayoutKind.Sequential)]
    public struct Geometry
    {
        public uint SizeOf;
        [MarshalAs(UnmanagedType.ByValArray, SizeConst = 3)] public int[] Size;
        [MarshalAs(UnmanagedType.ByValArray, SizeConst = 3)] public double[] Spacing;
        [MarshalAs(UnmanagedType.ByValArray, SizeConst = 3)] public double[] Origin;
        [MarshalAs(UnmanagedType.ByValArray, SizeConst = 9)] public double[] Direction;
    }

    [StructLayout(LayoutKind.Sequential)]
    public struct RenderOptions
    {
        public uint SizeOf;
        public int HasIsovalue;
        public double Isovalue, Stiffness, Damping, Viscosity, ForceLimit;
        public double StaticFriction, DynamicFriction, Penetration, Scale, Rate;
        [MarshalAs(UnmanagedType.LPStr)] public string Tool;
        [MarshalAs(UnmanagedType.LPStr)] public string Layers;
    }

    [StructLayout(LayoutKind.Sequential)]
    public struct FieldOptions
    {
        public uint SizeOf;
        public int Solid, Interpolation, HasBackground;
        public double Background;
    }

    [StructLayout(LayoutKind.Sequential)]
    public struct Vector
    {
        public double X, Y, Z;
        public double Length { get { return Math.Sqrt(X * X + Y * Y + Z * Z); } }
    }

    [StructLayout(LayoutKind.Sequential)]
    public struct Quaternion
    {
        public double X, Y, Z, W;
    }

    [StructLayout(LayoutKind.Sequential)]
    public struct Felt
    {
        public uint SizeOf;
        public int Mode, Status, Contacts;
        public double Time;
        public Vector Hip, Scp, Force, Torque;
        public Quaternion Hand, Proxy;
        public double Density, Isovalue;
        public int Layer, Inside;
    }

    [StructLayout(LayoutKind.Sequential)]
    public struct Transform
    {
        public uint SizeOf;
        public int Unused;
        public Vector Row0, Row1, Row2; // of the rotation
        public Vector Translation;
        public double Scale;
    }

    [StructLayout(LayoutKind.Sequential)]
    public struct Snapshot
    {
        public uint SizeOf;
        public int DeviceStatus;
        public long Number, Missed;
        public ulong Version;
        public Felt Felt;
        public Transform Transform;
        public Vector Position, Normal;
        public double Stiffness, Moment;
        public uint Buttons;
        public int Frozen, Clutched, ForcesOn;
    }

    [StructLayout(LayoutKind.Sequential)]
    public struct Report
    {
        public uint SizeOf;
        public int DeviceFailed;
        public long Ticks, Missed, Overruns, Unrecorded;
        public long LatenessP50, LatenessP99, LatenessMax; // [ns]
        public long ComputeP50, ComputeP99, ComputeMax;
    }

    [StructLayout(LayoutKind.Sequential)]
    public struct Reading
    {
        public uint SizeOf;
        public int Status; // 1: ready
        public Vector Position;
        public Quaternion Orientation;
        public double Age;
        public uint Buttons, Unused;
    }

    [StructLayout(LayoutKind.Sequential)]
    public struct Wrench
    {
        public uint SizeOf;
        public int Unused;
        public Vector Force, Torque;
    }

    [UnmanagedFunctionPointer(CallingConvention.Cdecl)]
    public delegate int ReadDevice(ref Reading reading, IntPtr context);
    [UnmanagedFunctionPointer(CallingConvention.Cdecl)]
    public delegate int WriteDevice(ref Wrench wrench, IntPtr context);
    [UnmanagedFunctionPointer(CallingConvention.Cdecl)]
    public delegate void CloseDevice(IntPtr context);

    [StructLayout(LayoutKind.Sequential)]
    public struct OwnDevice
    {
        public uint SizeOf;
        public int Buttons;
        [MarshalAs(UnmanagedType.LPStr)] public string Name;
        [MarshalAs(UnmanagedType.LPStr)] public string Model;
        public double MaximumForce, MaximumTorque, Stiffness, PhysicalDamping;
        public Vector WorkspaceLow, WorkspaceHigh;
        public double Rate;
        public int HasOrientation, Unused;
        public ReadDevice Read;
        public WriteDevice Write;
        public CloseDevice Close;
        public IntPtr Context;
    }

    [StructLayout(LayoutKind.Sequential)]
    public struct RunOptions
    {
        public uint SizeOf;
        public int Facing;
        public IntPtr Field, Render; // of unmanaged FieldOptions, RenderOptions
        [MarshalAs(UnmanagedType.LPStr)] public string Device;
        public IntPtr Own; // of an unmanaged OwnDevice
        [MarshalAs(UnmanagedType.LPStr)] public string Recording;
        public int NoRealTime, DeadmanButton;
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

    public static class Native
    {
        const string Library = "palpate-c";

        [DllImport(Library)] static extern IntPtr palpate_version();
        [DllImport(Library)] static extern IntPtr palpate_last_error();
        [DllImport(Library)] public static extern Status palpate_volume_copy(
            ref Geometry geometry, int type, float[] samples, UIntPtr bytes, out IntPtr volume);
        [DllImport(Library)] public static extern Status palpate_volume_load(
            [MarshalAs(UnmanagedType.LPStr)] string name, IntPtr options, out IntPtr volume);
        [DllImport(Library)] public static extern void palpate_volume_destroy(IntPtr volume);
        [DllImport(Library)] public static extern Status palpate_field_create(
            IntPtr volume, IntPtr options, out IntPtr field);
        [DllImport(Library)] public static extern void palpate_field_destroy(IntPtr field);
        [DllImport(Library)] public static extern Status palpate_mesh_create(
            IntPtr field, double isovalue, out IntPtr mesh);
        [DllImport(Library)] public static extern UIntPtr palpate_mesh_vertex_count(IntPtr mesh);
        [DllImport(Library)] public static extern UIntPtr palpate_mesh_triangle_count(IntPtr mesh);
        [DllImport(Library)] public static extern Status palpate_mesh_read(
            IntPtr mesh, [Out] float[] vertices, [Out] uint[] triangles);
        [DllImport(Library)] public static extern void palpate_mesh_destroy(IntPtr mesh);
        [DllImport(Library)] public static extern Status palpate_data_create(
            IntPtr volume, out IntPtr data);
        [DllImport(Library)] public static extern Status palpate_data_undo(IntPtr data, out int done);
        [DllImport(Library)] public static extern Status palpate_data_redo(IntPtr data, out int done);
        [DllImport(Library)] public static extern void palpate_data_destroy(IntPtr data);
        [DllImport(Library)] public static extern Status palpate_run_create(
            IntPtr data, ref RunOptions options, out IntPtr run);
        [DllImport(Library)] public static extern Status palpate_run_start(IntPtr run);
        [DllImport(Library)] public static extern Status palpate_run_stop(IntPtr run);
        [DllImport(Library)] public static extern void palpate_run_destroy(IntPtr run);
        [DllImport(Library)] public static extern Status palpate_run_snapshot(
            IntPtr run, ref Snapshot snapshot);
        [DllImport(Library)] public static extern Status palpate_run_report(
            IntPtr run, ref Report report);
        [DllImport(Library)] public static extern Status palpate_run_set_isovalue(
            IntPtr run, double isovalue);
        [DllImport(Library)] public static extern Status palpate_run_set_forces(IntPtr run, int on);
        [DllImport(Library)] public static extern Status palpate_run_set_frozen(IntPtr run, int on);
        [DllImport(Library)] public static extern Status palpate_run_set_scale(
            IntPtr run, double scale);
        [DllImport(Library)] public static extern Status palpate_run_set_stiffness(
            IntPtr run, double newtonPerMm);
        [DllImport(Library)] public static extern Status palpate_run_set_penetration(
            IntPtr run, double threshold);
        [DllImport(Library)] public static extern Status palpate_run_set_tool(
            IntPtr run, [MarshalAs(UnmanagedType.LPStr)] string tool);

        public static string Version { get { return Marshal.PtrToStringAnsi(palpate_version()); } }

        /// Throws for every other status.
        public static void Check(Status status)
        {
            if (status == Status.Ok) return;
            throw new PalpateException(status, Marshal.PtrToStringAnsi(palpate_last_error()));
        }

        public static uint SizeOf<T>() where T : struct { return (uint)Marshal.SizeOf(typeof(T)); }
    }
}
