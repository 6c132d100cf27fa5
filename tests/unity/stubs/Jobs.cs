// Stand-ins for Unity's job system and Burst. See ../signatures.txt.
using System;

namespace Unity.Jobs
{
    public interface IJob
    {
        void Execute();
    }

    public struct JobHandle
    {
        public void Complete() { }
    }

    public static class IJobExtensions
    {
        public static JobHandle Schedule<T>(this T jobData, JobHandle dependsOn = default(JobHandle)) where T : struct, IJob
        {
            var thread = new System.Threading.Thread(() => jobData.Execute());
            thread.Start();
            thread.Join();
            return new JobHandle();
        }
    }
}

namespace Unity.Burst
{
    [AttributeUsage(AttributeTargets.Struct | AttributeTargets.Class | AttributeTargets.Method)]
    public class BurstCompileAttribute : Attribute { }
}

namespace Unity.Collections.LowLevel.Unsafe
{
    [AttributeUsage(AttributeTargets.Field)]
    public sealed class NativeDisableUnsafePtrRestrictionAttribute : Attribute { }
}

namespace Unity.Collections
{
    [AttributeUsage(AttributeTargets.Field)]
    public sealed class ReadOnlyAttribute : Attribute { }

    [AttributeUsage(AttributeTargets.Field)]
    public sealed class WriteOnlyAttribute : Attribute { }
}
